use std::io::{BufRead, BufReader, ErrorKind, Read};

use super::check::within_limit;
use super::{LoadError, MAX_BYTES};

/// The logical lines of an OBJ or MTL file, as clean text.
///
/// A UTF-8 byte order mark is dropped (the parser would lose the first vertex to it), `\n`, `\r\n`
/// and a lone `\r` all end a line, a final `\` joins the next line, and bytes that are not UTF-8 are
/// read as Latin-1. The file is streamed: no copy of it is ever whole in memory.
pub(super) struct Lines<'a> {
    file: &'a str,
    reader: BufReader<Box<dyn Read + 'a>>,
    bytes: Vec<u8>,
    after_cr: bool,
    /// Physical lines read so far.
    read: usize,
}

impl<'a> Lines<'a> {
    /// # Errors
    /// When the file cannot be read, or is UTF-16 text.
    pub fn new(file: &'a str, source: Box<dyn Read + 'a>) -> Result<Self, LoadError> {
        let reader = BufReader::with_capacity(1 << 16, source);
        let mut lines = Self { file, reader, bytes: Vec::new(), after_cr: false, read: 0 };
        let start = lines.peek()?;
        if start.starts_with(&[0xEF, 0xBB, 0xBF]) {
            lines.reader.consume(3);
        } else if matches!(start, [0xFF, 0xFE, ..] | [0xFE, 0xFF, ..])
            || matches!(start, [a, 0, b, 0, ..] | [0, a, 0, b, ..] if *a != 0 && *b != 0)
        {
            return Err(LoadError::at(file, 1, "the text is UTF-16", "save the file as UTF-8"));
        }
        Ok(lines)
    }

    /// The next logical line and the number of its first physical line, from 1.
    pub fn next(&mut self) -> Result<Option<(usize, &str)>, LoadError> {
        self.bytes.clear();
        let first = self.read + 1;
        while self.append_line()? {
            // A comment's final backslash is part of a path in it more often than a continuation.
            if self.bytes.last() != Some(&b'\\') || self.bytes.trim_ascii_start().starts_with(b"#")
            {
                break;
            }
            self.bytes.pop();
            self.bytes.push(b' ');
        }
        if self.read < first {
            return Ok(None);
        }
        if str::from_utf8(&self.bytes).is_err() {
            let latin1: String = self.bytes.iter().copied().map(char::from).collect();
            self.bytes = latin1.into_bytes();
        }
        Ok(Some((first, str::from_utf8(&self.bytes).unwrap_or_default())))
    }

    /// Appends one physical line without its end; `false` at the end of the file.
    fn append_line(&mut self) -> Result<bool, LoadError> {
        let mut found = false;
        loop {
            let after_cr = std::mem::take(&mut self.after_cr);
            let buffer = self.peek()?;
            let (length, end) = match buffer {
                [] => {
                    self.read += usize::from(found);
                    return Ok(found);
                }
                [b'\n', ..] if after_cr => {
                    self.reader.consume(1);
                    continue;
                }
                _ => match buffer.iter().position(|b| matches!(b, b'\n' | b'\r')) {
                    Some(end) => (end, Some(buffer[end])),
                    None => (buffer.len(), None),
                },
            };
            within_limit(self.bytes.len(), "or more bytes in a line", MAX_BYTES, "break the line")
                .map_err(|(problem, cure)| {
                    LoadError::at(self.file, self.read + 1, problem, cure)
                })?;
            // `peek` borrows all of `self`; its bytes are still in the buffer.
            self.bytes.extend_from_slice(&self.reader.buffer()[..length]);
            self.reader.consume(length + usize::from(end.is_some()));
            found = true;
            if let Some(end) = end {
                self.after_cr = end == b'\r';
                self.read += 1;
                return Ok(true);
            }
        }
    }

    fn peek(&mut self) -> Result<&[u8], LoadError> {
        loop {
            match self.reader.fill_buf() {
                Ok(_) => return Ok(self.reader.buffer()),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(reason) => {
                    return Err(LoadError::Unreadable { file: self.file.to_owned(), reason });
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(bytes: &[u8]) -> Vec<(usize, String)> {
        let mut lines = Lines::new("test", Box::new(bytes)).expect("clean text");
        let mut list = Vec::new();
        while let Some((number, line)) = lines.next().expect("bytes in memory") {
            list.push((number, line.to_owned()));
        }
        list
    }

    fn numbered(expected: &[(usize, &str)]) -> Vec<(usize, String)> {
        expected.iter().map(|&(number, line)| (number, line.to_owned())).collect()
    }

    #[test]
    fn every_kind_of_line_end_counts_once() {
        for text in ["a\n\nb\n", "a\r\n\r\nb\r\n", "a\r\rb\r", "a\n\nb", "a\r\n\nb"] {
            assert_eq!(
                lines(text.as_bytes()),
                numbered(&[(1, "a"), (2, ""), (3, "b")]),
                "{text:?}"
            );
        }
        assert_eq!(lines(b""), []);
    }

    #[test]
    fn a_backslash_joins_lines_but_not_in_comments() {
        assert_eq!(lines(b"f 1 2\\\n3\nv"), numbered(&[(1, "f 1 2 3"), (3, "v")]));
        assert_eq!(lines(b"f 1\\\r\n2\\\r\n3\r\nv"), numbered(&[(1, "f 1 2 3"), (4, "v")]));
        assert_eq!(lines(b"f 1 \\"), numbered(&[(1, "f 1  ")]));
        assert_eq!(lines(b"# in C:\\\nv"), numbered(&[(1, "# in C:\\"), (2, "v")]));
    }

    #[test]
    fn marks_and_encodings() {
        assert_eq!(lines(b"\xEF\xBB\xBFv 1"), numbered(&[(1, "v 1")]));
        assert_eq!(lines(b"# caf\xE9\nv"), numbered(&[(1, "# café"), (2, "v")]));
        assert_eq!(lines("# café".as_bytes()), numbered(&[(1, "# café")]));
        for utf16 in [&b"\xFF\xFEv\0"[..], b"\xFE\xFF\0v", b"v\0 \x001\0", b"\0v\0 \x001"] {
            let error = Lines::new("test", Box::new(utf16)).map(|_| ()).expect_err("UTF-16");
            assert_eq!(error.to_string(), "test:1: the text is UTF-16; save the file as UTF-8");
        }
        assert_eq!(lines(b"\0\0\0\0\nv").len(), 2);
    }
}
