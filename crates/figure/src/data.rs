//! A figure's numbers as a tidy table: one observation a row.

/// One cell.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A name.
    Text(String),
    /// A measurement.
    Number(f64),
    /// A count.
    Integer(i64),
}

impl From<&str> for Value {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Value {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<f64> for Value {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<i64> for Value {
    fn from(integer: i64) -> Self {
        Self::Integer(integer)
    }
}

impl From<u32> for Value {
    fn from(integer: u32) -> Self {
        Self::Integer(integer.into())
    }
}

impl From<u64> for Value {
    /// # Panics
    /// If the count is 2⁶³ or more.
    fn from(integer: u64) -> Self {
        Self::Integer(integer.try_into().expect("a count stays below 2^63"))
    }
}

impl From<usize> for Value {
    fn from(integer: usize) -> Self {
        Self::from(integer as u64)
    }
}

impl Value {
    /// The field in a CSV file: numbers in the fewest digits that read back as the same `f64`, `NaN`,
    /// `inf`, `-inf`; text quoted where RFC 4180 asks for it.
    fn field(&self) -> String {
        match self {
            Self::Text(text) => quoted(text),
            Self::Number(number) => format!("{number:?}"),
            Self::Integer(integer) => integer.to_string(),
        }
    }
}

fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

/// Named columns and rows of cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    columns: Vec<String>,
    rows: Vec<Vec<Value>>,
}

impl Table {
    /// A table without rows.
    pub fn new<S: Into<String>>(columns: impl IntoIterator<Item = S>) -> Self {
        Self { columns: columns.into_iter().map(Into::into).collect(), rows: Vec::new() }
    }

    /// Appends a row.
    ///
    /// # Panics
    /// If it does not have one cell for each column.
    pub fn push(&mut self, row: impl IntoIterator<Item = Value>) {
        let row: Vec<Value> = row.into_iter().collect();
        assert_eq!(
            row.len(),
            self.columns.len(),
            "a row has a cell for each of {:?}",
            self.columns
        );
        self.rows.push(row);
    }

    /// The names of the columns.
    pub fn columns(&self) -> &[String] {
        &self.columns
    }

    /// The rows, in the order they were appended.
    pub fn rows(&self) -> &[Vec<Value>] {
        &self.rows
    }

    /// The rows with their columns' names, to be read by name.
    pub fn records(&self) -> Vec<Record> {
        let record = |row: &Vec<Value>| {
            let fields = row.iter().map(|value| match value {
                Value::Text(text) => text.clone(),
                number => number.field(),
            });
            Record(self.columns.iter().cloned().zip(fields).collect())
        };
        self.rows.iter().map(record).collect()
    }

    /// The table as a CSV file with a header; lines end with `\n`.
    pub fn to_csv(&self) -> String {
        let header = self.columns.iter().map(|name| quoted(name)).collect();
        let rows = self.rows.iter().map(|row| row.iter().map(Value::field).collect());
        let lines =
            std::iter::once(header).chain(rows).map(|fields: Vec<String>| fields.join(",") + "\n");
        lines.collect()
    }
}

/// A row of a [`Table`], by the names of its columns.
#[derive(Clone, Debug, PartialEq)]
pub struct Record(Vec<(String, String)>);

impl Record {
    /// A cell as the file has it, without quotes.
    ///
    /// # Panics
    /// If there is no such column.
    pub fn text(&self, column: &str) -> &str {
        let found = self.0.iter().find(|(name, _)| name == column);
        &found.unwrap_or_else(|| panic!("no column {column:?}")).1
    }

    /// A cell's number.
    ///
    /// # Panics
    /// If there is no such column, or no number in it.
    pub fn number(&self, column: &str) -> f64 {
        let text = self.text(column);
        text.parse().unwrap_or_else(|_| panic!("{column:?} has no number: {text:?}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_quoted_as_in_rfc_4180() {
        let mut table = Table::new(["method", "error, relative", "rays"]);
        table.push(["a \"b\", c\nd".into(), 0.1.into(), 3_u64.into()]);
        assert_eq!(
            table.to_csv(),
            "method,\"error, relative\",rays\n\"a \"\"b\"\", c\nd\",0.1,3\n"
        );
    }

    #[test]
    fn numbers_read_back_the_same() {
        for number in [
            0.1,
            1.0,
            1e-300,
            5e-324,
            1.0 / 3.0,
            -2.5e17,
            f64::MAX,
            f64::INFINITY,
            f64::NEG_INFINITY,
            -0.0,
        ] {
            let read: f64 = Value::Number(number).field().parse().unwrap();
            assert_eq!(read.to_bits(), number.to_bits());
        }
        assert_eq!(Value::Number(f64::NAN).field(), "NaN");
        assert_eq!(Value::Number(f64::NEG_INFINITY).field(), "-inf");
        assert_eq!(Value::Number(1.0).field(), "1.0", "a number, not a count");
    }

    #[test]
    #[should_panic(expected = "a cell for each")]
    fn a_short_row_is_refused() {
        Table::new(["a", "b"]).push([1.0.into()]);
    }

    #[test]
    fn records_are_read_by_name() {
        let mut table = Table::new(["method", "error", "rays"]);
        table.push(["a, b".into(), 0.5.into(), 3_u64.into()]);
        let [record] = &table.records()[..] else { panic!("a row") };
        assert_eq!((record.text("method"), record.number("error")), ("a, b", 0.5));
        assert_eq!((record.text("rays"), record.number("rays")), ("3", 3.0));
    }
}
