use std::collections::HashMap;
use std::io::Read;

use glam::DVec3;

use super::check::{Problem, excerpt, within_limit};
use super::clean::{Lines, words};
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

/// What the lines say.
#[derive(Default)]
pub(super) struct Record {
    vertices: usize,
    faces: usize,
    /// Of the `v` lines.
    pub positions: Vec<DVec3>,
    /// The corners of all faces, as indices into `positions`.
    pub corners: Vec<u32>,
    /// The number of corners of each face.
    pub arities: Vec<u32>,
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

/// Reads the statements of a file to its end.
pub(super) fn read<'a>(
    file: &'a str,
    source: Box<dyn Read + 'a>,
    warnings: &mut Warnings,
) -> Result<Record, LoadError> {
    let mut lines = Lines::new(file, source)?;
    let mut record = Record::default();
    let mut names = HashMap::new();
    while let Some((number, line)) = lines.next()? {
        let statement = line.trim_start();
        let (keyword, rest) = statement.split_once(char::is_whitespace).unwrap_or((statement, ""));
        let numbers = rest.split('#').next().unwrap_or_default();
        let invalid = |(problem, cure): Problem| LoadError::at(file, number, problem, cure);
        let finding = match keyword {
            "v" => record.vertex(numbers).map_err(invalid)?,
            "vn" => {
                record.add_normal(numbers).map_err(invalid)?;
                None
            }
            "f" => record.face(number, numbers).map_err(invalid)?,
            "usemtl" => {
                record.use_material(&mut names, number, rest.trim());
                None
            }
            "mtllib" => {
                record.libraries.push((rest.trim().to_owned(), number));
                None
            }
            "l" | "p" | "curv" | "curv2" | "surf" => Some(WarningKind::NotAFace),
            _ if keyword.is_empty() || keyword.starts_with('#') || SILENT.contains(&keyword) => {
                None
            }
            _ => Some(WarningKind::UnknownStatement),
        };
        if let Some(finding) = finding {
            warnings.add(file, number, finding);
        }
    }
    record
        .check_last_vertex()
        .map_err(|(line, (problem, cure))| LoadError::at(file, line, problem, cure))?;
    Ok(record)
}

/// No index of a vertex: there are at most [`MAX_COUNT`].
const UNUSED: u32 = MAX_COUNT as u32;

/// Statements of an OBJ that change nothing in a picture of this course.
const SILENT: [&str; 8] = ["vt", "vp", "g", "o", "s", "mg", "call", "csh"];

impl Record {
    fn count_vertex(&mut self) -> Result<(), Problem> {
        self.vertices += 1;
        within_limit(self.vertices, "vertices", MAX_COUNT, "split the model")
    }

    /// Keeps the position of a `v` line: three numbers, and a fourth by which they are divided, or colours, which are
    /// passed over.
    fn vertex(&mut self, numbers: &str) -> Result<Option<WarningKind>, Problem> {
        self.count_vertex()?;
        let mut words = words(numbers);
        let [x, y, z, weight, color] = std::array::from_fn(|_| words.next());
        let finding = color.map(|_| WarningKind::VertexColors);
        let unreadable = || {
            let shown = match (x, y, z, color) {
                (Some(x), Some(y), Some(z), Some(_)) => format!("v {x} {y} {z}"),
                _ => format!("v {numbers}"),
            };
            let problem = format!("`{}` cannot be read", excerpt(&shown));
            (problem, "write three numbers, with a decimal point")
        };
        let number = |word: Option<&str>| word.and_then(|word| word.parse::<f64>().ok());
        let [Some(x), Some(y), Some(z)] = [x, y, z].map(number) else { return Err(unreadable()) };
        let mut position = DVec3::new(x, y, z);
        if weight.is_some() && color.is_none() {
            let weight = number(weight).ok_or_else(unreadable)?;
            if weight == 0.0 {
                let problem = format!("`{}` has the weight 0", excerpt(&format!("v {numbers}")));
                return Err((problem, "remove the fourth number"));
            }
            position /= weight;
        }
        self.positions.push(position);
        Ok(finding)
    }

    /// Keeps the normal of a `vn` line if it has a direction.
    fn add_normal(&mut self, numbers: &str) -> Result<(), Problem> {
        let lines = self.normal_indices.len() + 1;
        within_limit(lines, "normals", MAX_COUNT, "split the model")?;
        let numbers: Vec<f64> =
            words(numbers).take(3).map_while(|word| word.parse().ok()).collect();
        let normal = if numbers.len() == 3 { unit(DVec3::from_slice(&numbers)) } else { None };
        self.normal_indices.push(normal.map(|_| self.normals.len() as u32));
        self.normals.extend(normal);
        Ok(())
    }

    /// Takes the positions that faces use, in the order of their first use, and numbers the corners accordingly.
    pub fn used_positions(&mut self) -> Vec<DVec3> {
        let all = std::mem::take(&mut self.positions);
        let mut used = Vec::with_capacity(all.len());
        let mut numbers = vec![UNUSED; all.len()];
        for corner in &mut self.corners {
            let number = &mut numbers[*corner as usize];
            if *number == UNUSED {
                *number = used.len() as u32;
                used.push(all[*corner as usize]);
            }
            *corner = *number;
        }
        used
    }

    /// The index into `normals` of the `vn` line of this number, if it exists and has a direction.
    pub fn normal(&self, number: u32) -> Option<u32> {
        *self.normal_indices.get((number as usize).checked_sub(1)?)?
    }

    /// Keeps the face of an `f` line, if it has three corners.
    fn face(&mut self, line: usize, corners: &str) -> Result<Option<WarningKind>, Problem> {
        let (first_corner, first_normal) = (self.corners.len(), self.corner_normals.len());
        let last_vertex = self.last_vertex;
        let read = self.read_corners(line, corners);
        // How many there are is said before what is wrong with one.
        let count = read.as_ref().map_or_else(|_| words(corners).count(), |&count| count);
        within_limit(count, "corners in one face", MAX_CORNERS, "split the face")?;
        if count < 3 {
            self.corners.truncate(first_corner);
            self.corner_normals.truncate(first_normal);
            self.last_vertex = last_vertex;
            return Ok(Some(WarningKind::TooFewCorners));
        }
        read?;
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
        self.arities.push(count as u32);
        self.faces += 1;
        within_limit(self.faces, "faces", MAX_COUNT, "split the model")?;
        Ok((named > 0 && !with_normals).then_some(WarningKind::PartialNormals))
    }

    /// Appends corners and their normals, and counts the corners.
    fn read_corners(&mut self, line: usize, corners: &str) -> Result<usize, Problem> {
        let first = self.corners.len();
        for corner in words(corners) {
            let (vertex, others) = split_at_slash(corner);
            let vertex = vertex_index(vertex, corner, self.vertices)?;
            if vertex > self.last_vertex.0 {
                self.last_vertex = (vertex, line);
            }
            self.corners.push((vertex - 1) as u32);
            // The part between is a texture's.
            let normal = others.and_then(|others| split_at_slash(others).1).map(split_at_slash);
            if let Some((normal, _)) = normal.filter(|(normal, _)| !normal.is_empty()) {
                self.corner_normals.push(normal_number(normal, self.normal_indices.len()));
            }
        }
        Ok(self.corners.len() - first)
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

/// What stands before the first slash, and behind it if there is one.
fn split_at_slash(text: &str) -> (&str, Option<&str>) {
    match text.bytes().position(|byte| byte == b'/') {
        Some(slash) => (&text[..slash], Some(&text[slash + 1..])),
        None => (text, None),
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
