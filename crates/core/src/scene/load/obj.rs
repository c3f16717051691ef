use std::io::Read;
use std::path::Path;

use glam::DVec3;

use super::check::{is_in_space, within_limit};
use super::clean::Lines;
use super::mtl::{Library, NamedMaterials};
use super::report::{LoadError, WarningKind, Warnings};
use super::statements::{self, Record};
use super::{DEFAULT_GREY, MAX_COORDINATE, MAX_COUNT, Open, UNNAMED};
use crate::geometry::triangulate;
use crate::scene::counts::is_zero_area;
use crate::scene::{Face, FaceId, Material, MaterialId, Mesh, Triangle};

/// Where the materials of an OBJ file come from.
#[derive(Clone, Copy)]
pub(super) enum Materials {
    /// Its libraries.
    Own,
    /// The scene file, which gives one for all faces: the libraries are not read.
    Replaced,
}

/// Reads an OBJ file and its material libraries; materials come with their names. If they are replaced there are
/// none, and all faces have the number 0.
pub(super) fn read_obj(
    path: &Path,
    materials: Materials,
    open: Open<'_>,
    warnings: &mut Warnings,
) -> Result<(Mesh, NamedMaterials), LoadError> {
    let file = path.display().to_string();
    let source = Source { path, file: &file, open };
    let mut record = statements::read(&file, source.open()?, warnings)?;
    if record.corners.is_empty() {
        return Err(LoadError::at(
            &file,
            None,
            "nothing to draw: no face with 3 corners",
            "check that this is an OBJ file with `v` and `f` lines",
        ));
    }
    let (materials, run_materials) = match materials {
        Materials::Own => {
            let library = Library::of_model(path, &record.libraries, open, warnings);
            resolve_materials(&file, library, &record, warnings)?
        }
        Materials::Replaced => (Vec::new(), vec![MaterialId(0); record.runs.len()]),
    };
    let mesh = source.build_mesh(&mut record, &run_materials, warnings)?;
    Ok((mesh, materials))
}

/// The material of each run. Runs without one get a default material at the end of the list.
///
/// # Errors
/// When a material that a face uses has a wrong value.
fn resolve_materials(
    file: &str,
    library: Library,
    record: &Record,
    warnings: &mut Warnings,
) -> Result<(NamedMaterials, Vec<MaterialId>), LoadError> {
    let mut resolve = |(name, line): &(String, usize)| {
        let (id, finding) = library.find(name);
        if let Some(finding) = finding {
            warnings.add(file, *line, finding);
        }
        id
    };
    let named: Vec<Option<MaterialId>> = record.material_names.iter().map(&mut resolve).collect();
    let found: Vec<Option<MaterialId>> =
        record.runs.iter().map(|run| run.material.and_then(|name| named[name])).collect();
    let mut materials = library.into_named(&found, warnings)?;
    let default = MaterialId(materials.len() as u32);
    if found.contains(&None) {
        materials.push((UNNAMED.to_owned(), Material::matte(DEFAULT_GREY)));
    }
    Ok((materials, found.into_iter().map(|id| id.unwrap_or(default)).collect()))
}

/// An OBJ file that can be read again, to find the line of what turned out wrong.
struct Source<'a> {
    path: &'a Path,
    file: &'a str,
    open: Open<'a>,
}

impl<'a> Source<'a> {
    fn open(&self) -> Result<Box<dyn Read + 'a>, LoadError> {
        (self.open)(self.path, None)
            .map_err(|reason| LoadError::Unreadable { file: self.file.to_owned(), reason })
    }

    /// The first line whose keyword and numbers are `wanted`.
    fn find_line(&self, mut wanted: impl FnMut(&str, &str) -> bool) -> Option<usize> {
        let mut lines = Lines::new(self.file, self.open().ok()?).ok()?;
        while let Ok(Some((number, line))) = lines.next() {
            let statement = line.trim_start();
            if let Some((keyword, rest)) = statement.split_once(char::is_whitespace)
                && wanted(keyword, rest.split('#').next().unwrap_or_default())
            {
                return Some(number);
            }
        }
        None
    }

    fn line_of_vertex(&self, is_bad: impl Fn(DVec3) -> bool) -> Option<usize> {
        self.find_line(|keyword, numbers| {
            let numbers: Vec<f64> =
                numbers.split_whitespace().map_while(|word| word.parse().ok()).collect();
            let weight = if let [_, _, _, weight] = numbers[..] { weight } else { 1.0 };
            keyword == "v" && numbers.len() >= 3 && is_bad(DVec3::from_slice(&numbers) / weight)
        })
    }

    fn line_of_face(&self, face: usize) -> Option<usize> {
        let mut seen = 0;
        self.find_line(|keyword, corners| {
            seen += usize::from(keyword == "f" && corners.split_whitespace().nth(2).is_some());
            seen > face
        })
    }

    fn build_mesh(
        &self,
        record: &mut Record,
        materials: &[MaterialId],
        warnings: &mut Warnings,
    ) -> Result<Mesh, LoadError> {
        let positions = record.used_positions();
        if !positions.iter().copied().all(is_in_space) {
            return Err(LoadError::at(
                self.file,
                self.line_of_vertex(|p| !is_in_space(p)),
                format!("a coordinate is not finite, or beyond ±{MAX_COORDINATE:e}"),
                "correct the number",
            ));
        }
        let faces = record.arities.len();
        let triangles = record.corners.len() - 2 * faces;
        within_limit(triangles, "triangles", MAX_COUNT, "split the model")
            .map_err(|(problem, cure)| LoadError::at(self.file, None, problem, cure))?;
        let mut mesh = Mesh { positions, ..Mesh::default() };
        mesh.faces.reserve_exact(faces);
        mesh.triangles.reserve_exact(triangles);
        let runs = &record.runs;
        let any_normals = !record.corner_normals.is_empty();
        if any_normals {
            mesh.smooth.reserve_exact(triangles);
        }

        let mut findings = Findings::default();
        let (mut polygon, mut parts, mut normals) = (Vec::new(), Vec::new(), Vec::new());
        let (mut start, mut run, mut any_smooth) = (0, 0, false);
        let mut corner_normals = record.corner_normals.iter();
        for (face, &arity) in record.arities.iter().enumerate() {
            let end = start + arity as usize;
            while runs.get(run + 1).is_some_and(|next| next.first_face <= face) {
                run += 1;
            }
            let corners = &record.corners[start..end];
            polygon.clear();
            polygon.extend(corners.iter().map(|&vertex| mesh.positions[vertex as usize]));
            parts.clear();
            let defects = triangulate(&polygon, &mut parts);
            normals.clear();
            if runs[run].with_normals {
                let named = corner_normals.by_ref().take(corners.len());
                normals.extend(named.filter_map(|&number| record.normal(number)));
            }
            let smooth = runs[run].with_normals && normals.len() == corners.len();
            any_smooth |= smooth;
            let is_flat = |part: &&[u32; 3]| is_zero_area(part.map(|i| polygon[i as usize]));
            for (kind, count) in [
                (WarningKind::UnusableNormals, usize::from(runs[run].with_normals && !smooth)),
                (WarningKind::SelfIntersecting, usize::from(defects.self_intersecting)),
                (WarningKind::NonPlanar, usize::from(defects.non_planar)),
                (WarningKind::ZeroArea, parts.iter().filter(is_flat).count()),
            ] {
                findings.note(kind, face, count);
            }

            let (first, count) = (mesh.triangles.len() as u32, parts.len() as u32);
            mesh.faces.push(Face { material: materials[run], first, count });
            let face = FaceId(face as u32);
            mesh.triangles.extend(
                parts
                    .iter()
                    .map(|part| Triangle { vertices: part.map(|i| corners[i as usize]), face }),
            );
            if any_normals {
                let of_part = |part: &[u32; 3]| smooth.then(|| part.map(|i| normals[i as usize]));
                mesh.smooth.extend(parts.iter().map(of_part));
            }
            start = end;
        }
        for (kind, face, count) in findings.0 {
            warnings.add_many(self.file, self.line_of_face(face), kind, count);
        }
        if any_smooth {
            mesh.normals = std::mem::take(&mut record.normals);
        } else {
            mesh.smooth = Vec::new();
        }
        Ok(mesh)
    }
}

/// Findings about faces: their kind, the first face, how many.
#[derive(Default)]
struct Findings(Vec<(WarningKind, usize, usize)>);

impl Findings {
    fn note(&mut self, kind: WarningKind, face: usize, count: usize) {
        if count == 0 {
            return;
        }
        match self.0.iter_mut().find(|finding| finding.0 == kind) {
            Some(finding) => finding.2 += count,
            None => self.0.push((kind, face, count)),
        }
    }
}
