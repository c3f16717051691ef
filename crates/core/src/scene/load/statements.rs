use std::collections::HashMap;
use std::io::{self, BufRead, Read};

use glam::DVec3;

use super::check::{Problem, excerpt, within_limit};
use super::clean::Lines;
use super::report::{LoadError, WarningKind, Warnings};
use super::{MAX_CORNERS, MAX_COUNT};

/// Consecutive faces with the same material and kind of shading.
pub(super) struct Run {
    pub first_face: usize,
    /// Index into [`Record::material_names`]; `None` before any `usemtl`.
    pub material: Option<usize>,
    /// Whether all corners name a normal, which stands in [`Record::corner_normals`].
    pub with_normals: bool,
}

/// What the lines say beyond the numbers that tobj reads.
#[derive(Default)]
pub(super) struct Record {
    vertices: usize,
    faces: usize,
    pub runs: Vec<Run>,
    /// Of the `vn` lines those that have a direction, of unit length.
    pub normals: Vec<DVec3>,
    /// For each `vn` line, from the first, its index into `normals`.
    normal_indices: Vec<Option<u32>>,
    /// The numbers of the `vn` lines that corners name, of the faces of all runs with normals. They may follow
    /// the faces that use them, or never come.
    pub corner_normals: Vec<u32>,
    material: Option<usize>,
    /// The names after `usemtl`, each with the line that uses it first.
    pub material_names: Vec<(String, usize)>,
    /// The names after `mtllib`, with their lines.
    pub libraries: Vec<(String, usize)>,
    /// The largest absolute index, and its line: vertices may follow the faces that use them.
    last_vertex: (usize, usize),
}

/// Feeds tobj the positions and the vertices of the faces of a file, and records what else it says.
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
                "v" => {
                    self.record.count_vertex().map_err(invalid)?;
                    true
                }
                "vn" => {
                    self.record.add_normal(numbers).map_err(invalid)?;
                    false
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
                self.line.push_str(keyword);
                if keyword == "f" {
                    for corner in numbers.split_whitespace() {
                        let vertex = corner.split('/').next().unwrap_or_default();
                        self.line.extend([" ", vertex]);
                    }
                } else if numbers.split_whitespace().nth(4).is_some() {
                    self.warnings.add(self.file, number, WarningKind::VertexColors);
                    for coordinate in numbers.split_whitespace().take(3) {
                        self.line.extend([" ", coordinate]);
                    }
                } else {
                    self.line.extend([" ", numbers]);
                }
                self.line.push('\n');
                return Ok(());
            }
        }
        self.record
            .check_last_vertex()
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
    fn count_vertex(&mut self) -> Result<(), Problem> {
        self.vertices += 1;
        within_limit(self.vertices, "vertices", MAX_COUNT, "split the model")
    }

    /// Keeps the normal of a `vn` line if it has a direction.
    fn add_normal(&mut self, numbers: &str) -> Result<(), Problem> {
        let lines = self.normal_indices.len() + 1;
        within_limit(lines, "normals", MAX_COUNT, "split the model")?;
        let numbers: Vec<f64> =
            numbers.split_whitespace().take(3).map_while(|word| word.parse().ok()).collect();
        let normal = if numbers.len() == 3 { unit(DVec3::from_slice(&numbers)) } else { None };
        self.normal_indices.push(normal.map(|_| self.normals.len() as u32));
        self.normals.extend(normal);
        Ok(())
    }

    /// The index into `normals` of the `vn` line of this number, if it exists and has a direction.
    pub fn normal(&self, number: u32) -> Option<u32> {
        *self.normal_indices.get((number as usize).checked_sub(1)?)?
    }

    /// Checks and counts the face `corners`: tobj does not name the line of a bad index.
    fn face(&mut self, line: usize, corners: &str) -> Result<Option<FaceDefect>, Problem> {
        let count = corners.split_whitespace().count();
        within_limit(count, "corners in one face", MAX_CORNERS, "split the face")?;
        if count < 3 {
            return Ok(Some(FaceDefect::TooFewCorners));
        }
        let first_normal = self.corner_normals.len();
        for corner in corners.split_whitespace() {
            let mut parts = corner.split('/');
            let vertex = vertex_index(parts.next().unwrap_or_default(), corner, self.vertices)?;
            if vertex > self.last_vertex.0 {
                self.last_vertex = (vertex, line);
            }
            // The part between is a texture's.
            if let Some(normal) = parts.nth(1).filter(|normal| !normal.is_empty()) {
                self.corner_normals.push(normal_number(normal, self.normal_indices.len()));
            }
        }
        let named = self.corner_normals.len() - first_normal;
        let with_normals = named == count;
        if !with_normals {
            self.corner_normals.truncate(first_normal);
        }
        let continues =
            |run: &Run| run.material == self.material && run.with_normals == with_normals;
        if !self.runs.last().is_some_and(continues) {
            self.runs.push(Run { first_face: self.faces, material: self.material, with_normals });
        }
        self.faces += 1;
        within_limit(self.faces, "faces", MAX_COUNT, "split the model")?;
        Ok((named > 0 && !with_normals).then_some(FaceDefect::PartialNormals))
    }

    fn use_material(&mut self, names: &mut HashMap<String, usize>, line: usize, name: &str) {
        let index = names.get(name).copied().unwrap_or_else(|| {
            self.material_names.push((name.to_owned(), line));
            names.insert(name.to_owned(), self.material_names.len() - 1);
            self.material_names.len() - 1
        });
        self.material = Some(index);
    }

    fn check_last_vertex(&self) -> Result<(), (usize, Problem)> {
        let (last, line) = self.last_vertex;
        if last > self.vertices {
            return Err((line, out_of_range(&last.to_string(), self.vertices)));
        }
        Ok(())
    }
}

/// The number, from 1, of the vertex that `text` means when `count` of them stand before it.
fn vertex_index(text: &str, corner: &str, count: usize) -> Result<usize, Problem> {
    let index: i64 = text.parse().map_err(|_| not_a_corner(corner))?;
    let distance = usize::try_from(index.unsigned_abs()).unwrap_or(usize::MAX);
    match index.signum() {
        1 if distance <= MAX_COUNT => Ok(distance),
        -1 if distance <= count => Ok(count - distance + 1),
        _ => Err(out_of_range(text, count)),
    }
}

/// The same of a normal; 0 where there can be none.
fn normal_number(text: &str, count: usize) -> u32 {
    let index: i64 = text.parse().unwrap_or(0);
    let number = if index < 0 { count as i64 + 1 + index } else { index };
    u32::try_from(number).unwrap_or(0)
}

/// The unit vector of a normal of any finite length but 0; squares of very short and very long ones
/// would leave the range of numbers.
fn unit(normal: DVec3) -> Option<DVec3> {
    (normal / normal.abs().max_element()).try_normalize()
}

fn not_a_corner(corner: &str) -> Problem {
    let problem = format!("`{}` is not a corner of a face", excerpt(corner));
    (
        problem,
        "write vertex, vertex/texture, vertex//normal or vertex/texture/normal, as whole numbers",
    )
}

fn out_of_range(index: &str, count: usize) -> Problem {
    (
        format!("the face names number {index} of {count} vertices"),
        "count from 1, or back from -1 for the latest",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The limits that no test file can reach, with both numbers.
    #[test]
    fn counts_beyond_32_bits_are_refused() {
        let mut full = Record { vertices: MAX_COUNT, faces: MAX_COUNT, ..Record::default() };
        let cure = "split the model";
        let beyond = |what| (format!("4294967296 {what}, the maximum is 4294967295"), cure);
        assert_eq!(full.count_vertex().err(), Some(beyond("vertices")));
        assert_eq!(full.face(1, "1 2 3").err(), Some(beyond("faces")));
    }
}
