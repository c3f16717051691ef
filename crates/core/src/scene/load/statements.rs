use std::collections::HashMap;
use std::io::{self, BufRead, Read};

use super::check::{Problem, excerpt, within_limit};
use super::clean::Lines;
use super::report::{LoadError, WarningKind, Warnings};
use super::{MAX_CORNERS, MAX_COUNT};

/// Consecutive faces with the same material and kind of shading.
pub(super) struct Run {
    pub first_face: usize,
    /// Index into [`Record::material_names`]; `None` before any `usemtl`.
    pub material: Option<usize>,
    pub smooth: bool,
}

/// What the lines say beyond the numbers that tobj reads.
#[derive(Default)]
pub(super) struct Record {
    vertices: usize,
    normals: usize,
    faces: usize,
    pub runs: Vec<Run>,
    material: Option<usize>,
    /// The names after `usemtl`, each with the line that uses it first.
    pub material_names: Vec<(String, usize)>,
    /// The names after `mtllib`, with their lines.
    pub libraries: Vec<(String, usize)>,
    /// The largest absolute indices, and their lines: vertices may follow the faces that use them.
    last_vertex: (usize, usize),
    last_normal: (usize, usize),
}

/// Feeds tobj the `v`, `vn` and `f` lines of a file and records the others.
pub(super) struct Statements<'a, 'w> {
    file: &'a str,
    lines: Lines<'a>,
    warnings: &'w mut Warnings,
    pub record: Record,
    names: HashMap<String, usize>,
    /// The line tobj is reading, and how much of it tobj has taken.
    pub line: String,
    taken: usize,
    pub number: usize,
    /// Why reading stopped.
    pub error: Option<LoadError>,
}

impl<'a, 'w> Statements<'a, 'w> {
    pub fn new(
        file: &'a str,
        source: Box<dyn Read + 'a>,
        warnings: &'w mut Warnings,
    ) -> Result<Self, LoadError> {
        Ok(Self {
            file,
            lines: Lines::new(file, source)?,
            warnings,
            record: Record::default(),
            names: HashMap::new(),
            line: String::new(),
            taken: 0,
            number: 0,
            error: None,
        })
    }

    /// Reads on to the next line for tobj; leaves `line` empty at the end of the file.
    fn advance(&mut self) -> Result<(), LoadError> {
        self.line.clear();
        self.taken = 0;
        while let Some((number, line)) = self.lines.next()? {
            let statement = line.trim_start();
            let (keyword, rest) =
                statement.split_once(char::is_whitespace).unwrap_or((statement, ""));
            let numbers = rest.split('#').next().unwrap_or_default();
            let invalid =
                |(problem, cure): Problem| LoadError::at(self.file, number, problem, cure);
            let for_tobj = match keyword {
                "v" | "vn" => {
                    self.record.count(keyword).map_err(invalid)?;
                    true
                }
                "f" => match self.record.face(number, numbers).map_err(invalid)? {
                    None => true,
                    Some(FaceDefect::TooFewCorners) => {
                        self.warnings.add(self.file, number, WarningKind::TooFewCorners);
                        false
                    }
                    Some(FaceDefect::PartialNormals) => {
                        self.warnings.add(self.file, number, WarningKind::PartialNormals);
                        true
                    }
                },
                "usemtl" | "mtllib" if rest.trim().is_empty() => {
                    let problem = format!("`{keyword}` without a name");
                    return Err(invalid((problem, "name one or remove the line")));
                }
                "usemtl" => {
                    self.record.use_material(&mut self.names, number, rest.trim());
                    false
                }
                "mtllib" => {
                    self.record.libraries.push((rest.trim().to_owned(), number));
                    false
                }
                "l" | "p" | "curv" | "curv2" | "surf" => {
                    self.warnings.add(self.file, number, WarningKind::NotAFace);
                    false
                }
                _ => {
                    if !(keyword.is_empty()
                        || keyword.starts_with('#')
                        || SILENT.contains(&keyword))
                    {
                        self.warnings.add(self.file, number, WarningKind::UnknownStatement);
                    }
                    false
                }
            };
            if for_tobj {
                self.number = number;
                self.line.extend([keyword, " ", numbers, "\n"]);
                return Ok(());
            }
        }
        self.record
            .check_last_indices()
            .map_err(|(line, (problem, cure))| LoadError::at(self.file, line, problem, cure))
    }
}

impl Read for Statements<'_, '_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.fill_buf()?.read(buffer)?;
        self.consume(count);
        Ok(count)
    }
}

impl BufRead for Statements<'_, '_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.taken == self.line.len()
            && let Err(error) = self.advance()
        {
            self.error = Some(error);
            return Err(io::ErrorKind::InvalidData.into());
        }
        Ok(&self.line.as_bytes()[self.taken..])
    }

    fn consume(&mut self, count: usize) {
        self.taken += count;
    }
}

/// Statements of an OBJ that change nothing in a picture of this course.
const SILENT: [&str; 8] = ["vt", "vp", "g", "o", "s", "mg", "call", "csh"];

enum FaceDefect {
    TooFewCorners,
    PartialNormals,
}

impl Record {
    /// Counts a `v` or `vn` line.
    fn count(&mut self, keyword: &str) -> Result<(), Problem> {
        let (counter, what) = if keyword == "v" {
            (&mut self.vertices, "vertices")
        } else {
            (&mut self.normals, "normals")
        };
        *counter += 1;
        within_limit(*counter, what, MAX_COUNT, "split the model")
    }

    /// Checks and counts the face `corners`. tobj does not name the line of a bad index, and
    /// overflows on normals far out of range.
    fn face(&mut self, line: usize, corners: &str) -> Result<Option<FaceDefect>, Problem> {
        let (mut count, mut with_normal) = (0, 0);
        for corner in corners.split_ascii_whitespace() {
            count += 1;
            let mut parts = corner.split('/');
            let vertex = index(parts.next(), corner, self.vertices, "vertices")?;
            if vertex > self.last_vertex.0 {
                self.last_vertex = (vertex, line);
            }
            let texture = parts.next();
            if let Some(normal) = parts.next().filter(|normal| !normal.is_empty()) {
                let normal = index(Some(normal), corner, self.normals, "normals")?;
                if normal > self.last_normal.0 {
                    self.last_normal = (normal, line);
                }
                with_normal += 1;
            }
            let is_texture = |text: &str| text.is_empty() || text.parse::<i64>().is_ok();
            if !texture.is_none_or(is_texture) || parts.next().is_some() {
                return Err(not_a_corner(corner));
            }
        }
        within_limit(count, "corners in one face", MAX_CORNERS, "split the face")?;
        if count < 3 {
            return Ok(Some(FaceDefect::TooFewCorners));
        }
        let smooth = with_normal == count;
        if self.runs.last().is_none_or(|run| run.material != self.material || run.smooth != smooth)
        {
            self.runs.push(Run { first_face: self.faces, material: self.material, smooth });
        }
        self.faces += 1;
        within_limit(self.faces, "faces", MAX_COUNT, "split the model")?;
        Ok((with_normal > 0 && !smooth).then_some(FaceDefect::PartialNormals))
    }

    fn use_material(&mut self, names: &mut HashMap<String, usize>, line: usize, name: &str) {
        let index = names.get(name).copied().unwrap_or_else(|| {
            self.material_names.push((name.to_owned(), line));
            names.insert(name.to_owned(), self.material_names.len() - 1);
            self.material_names.len() - 1
        });
        self.material = Some(index);
    }

    fn check_last_indices(&self) -> Result<(), (usize, Problem)> {
        for ((last, line), count, what) in [
            (self.last_vertex, self.vertices, "vertices"),
            (self.last_normal, self.normals, "normals"),
        ] {
            if last > count {
                return Err((line, out_of_range(&last.to_string(), count, what)));
            }
        }
        Ok(())
    }
}

/// The number, from 1, that `text` means when `count` elements stand before it.
fn index(text: Option<&str>, corner: &str, count: usize, what: &str) -> Result<usize, Problem> {
    let text = text.unwrap_or_default();
    let index: i64 = text.parse().map_err(|_| not_a_corner(corner))?;
    let distance = usize::try_from(index.unsigned_abs()).unwrap_or(usize::MAX);
    match index.signum() {
        1 if distance <= MAX_COUNT => Ok(distance),
        -1 if distance <= count => Ok(count - distance + 1),
        _ => Err(out_of_range(text, count, what)),
    }
}

fn not_a_corner(corner: &str) -> Problem {
    let problem = format!("`{}` is not a corner of a face", excerpt(corner));
    (
        problem,
        "write vertex, vertex/texture, vertex//normal or vertex/texture/normal, as whole numbers",
    )
}

fn out_of_range(index: &str, count: usize, what: &str) -> Problem {
    (
        format!("the face names number {index} of {count} {what}"),
        "count from 1, or back from -1 for the latest",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The limits that no test file can reach, with both numbers.
    #[test]
    fn counts_beyond_32_bits_are_refused() {
        let mut full = Record {
            vertices: MAX_COUNT,
            normals: MAX_COUNT,
            faces: MAX_COUNT,
            ..Record::default()
        };
        let cure = "split the model";
        let beyond = |what| (format!("4294967296 {what}, the maximum is 4294967295"), cure);
        assert_eq!(full.count("v").err(), Some(beyond("vertices")));
        assert_eq!(full.count("vn").err(), Some(beyond("normals")));
        assert_eq!(full.face(1, "1 2 3").err(), Some(beyond("faces")));
    }
}
