use std::collections::HashMap;
use std::io::Read;
use std::path::{Path, PathBuf};

use super::check::beside;
use super::clean::Lines;
use super::definition::Definition;
use super::report::{LoadError, WarningKind, Warnings};
use super::{DEFAULT_GREY, Open};
use crate::scene::{Material, MaterialId};

/// Materials with their names, in the order in which they are numbered.
pub(super) type NamedMaterials = Vec<(String, Material)>;

/// The materials of all libraries of one OBJ file.
///
/// The first of two materials of one name counts.
#[derive(Default)]
pub(super) struct Library {
    entries: Vec<Entry>,
    names: HashMap<String, MaterialId>,
    /// Names that end before a comment, of the first material of each.
    bare_names: HashMap<String, MaterialId>,
}

struct Entry {
    name: String,
    /// The file it stands in, and the line of its `newmtl`.
    file: String,
    line: usize,
    definition: Definition,
}

/// What a statement of a library belongs to.
enum Current {
    Nothing,
    /// A material without a name, or with one that is taken.
    LeftOut,
    Last,
}

impl Library {
    /// The materials of the libraries that the OBJ file `model` names at the given lines.
    ///
    /// Nothing outside the model's folder is opened: of a library elsewhere, such as one named by the path of
    /// another machine, the file of that name beside the model is read. A link that leads out is as good as missing.
    pub fn of_model(
        model: &Path,
        names: &[(String, usize)],
        open: Open<'_>,
        warnings: &mut Warnings,
    ) -> Self {
        let mut library = Self::default();
        let file = model.display().to_string();
        let folder = model.parent().unwrap_or(Path::new(""));
        let mut paths: Vec<PathBuf> = Vec::new();
        for (name, line) in names {
            for found in find_files(folder, name, open) {
                let (path, text, findings) = match found {
                    Ok(found) => found,
                    Err(finding) => {
                        warnings.add(&file, *line, finding);
                        continue;
                    }
                };
                if let Some(finding) = findings {
                    warnings.add(&file, *line, finding);
                }
                if !paths.contains(&path) {
                    library.read(&path.display().to_string(), text, warnings);
                    paths.push(path);
                }
            }
        }
        library
    }

    /// The material that `name` means after `usemtl`, and what there is to say about it.
    pub fn find(&self, name: &str) -> (Option<MaterialId>, Option<WarningKind>) {
        if let Some(&id) = self.names.get(name) {
            return (Some(id), None);
        }
        let bare = without_comment(name);
        if bare.is_empty() {
            return (None, Some(WarningKind::Nameless("usemtl")));
        }
        // `Material #27` does not mean `Material #25`.
        let names = if bare == name { &self.bare_names } else { &self.names };
        match names.get(bare) {
            Some(&id) => (Some(id), Some(WarningKind::CommentAfterName)),
            None => (None, Some(WarningKind::UnknownMaterial)),
        }
    }

    /// All materials.
    ///
    /// # Errors
    /// When one of the `used` materials has a wrong value. Others become light grey.
    pub fn into_named(
        self,
        used: &[Option<MaterialId>],
        warnings: &mut Warnings,
    ) -> Result<NamedMaterials, LoadError> {
        let mut is_used = vec![false; self.entries.len()];
        used.iter().flatten().for_each(|id| is_used[id.0 as usize] = true);
        let mut named = Vec::with_capacity(self.entries.len());
        for (entry, is_used) in self.entries.into_iter().zip(is_used) {
            let material = match entry.definition.material() {
                Err((line, (problem, cure))) if is_used => {
                    return Err(LoadError::at(&entry.file, line, problem, cure));
                }
                material => material.unwrap_or(Material::matte(DEFAULT_GREY)),
            };
            for line in entry.definition.wrong_lines() {
                warnings.add(&entry.file, line, WarningKind::UnneededValue);
            }
            named.push((entry.name, material));
        }
        Ok(named)
    }

    /// Adds the materials of an MTL file, or those before the place where it cannot be read.
    fn read(&mut self, file: &str, text: Box<dyn Read + '_>, warnings: &mut Warnings) {
        let first = self.entries.len();
        if let Err(error) = self.read_statements(file, text, warnings) {
            let (line, reason) = error.into_parts();
            warnings.add(file, line, WarningKind::UnreadableLibrary { reason });
        }
        // Many exporters have written `Tr 1`, and some `d 0`, for what is opaque.
        let added = &mut self.entries[first..];
        let is_invisible =
            |entry: &Entry| entry.definition.material().is_ok_and(|m| m.is_invisible());
        if !added.is_empty() && added.iter().all(is_invisible) {
            warnings.add(file, added[0].line, WarningKind::InvisibleLibrary);
            added.iter_mut().for_each(|entry| entry.definition.exchange_opacity());
        }
    }

    /// # Errors
    /// When the file cannot be read as text.
    fn read_statements(
        &mut self,
        file: &str,
        text: Box<dyn Read + '_>,
        warnings: &mut Warnings,
    ) -> Result<(), LoadError> {
        let mut lines = Lines::new(file, text)?;
        let mut current = Current::Nothing;
        while let Some((number, line)) = lines.next()? {
            let statement = line.trim();
            let (keyword, rest) =
                statement.split_once(char::is_whitespace).unwrap_or((statement, ""));
            match keyword {
                "" | "Ka" => {}
                _ if keyword.starts_with('#') => {}
                "newmtl" => {
                    current = match self.define(rest.trim(), file, number) {
                        Ok(()) => Current::Last,
                        Err(finding) => {
                            warnings.add(file, number, finding);
                            Current::LeftOut
                        }
                    };
                }
                _ if Definition::KEYWORDS.contains(&keyword) => {
                    let words = rest.split('#').next().unwrap_or_default();
                    match (&current, self.entries.last_mut()) {
                        (Current::Last, Some(Entry { definition, .. })) => {
                            let warn = &mut |kind| warnings.add(file, number, kind);
                            definition.set(keyword, words, number, warn);
                        }
                        (Current::LeftOut, _) => {}
                        _ => warnings.add(file, number, WarningKind::BeforeMaterial),
                    }
                }
                _ => {
                    let ignored = IGNORED.iter().find(|&&ignored| ignored == keyword);
                    let kind =
                        ignored.map_or(WarningKind::UnknownStatement, |k| WarningKind::Ignored(k));
                    warnings.add(file, number, kind);
                }
            }
        }
        Ok(())
    }

    /// Adds a material without statements; the first of a name counts.
    fn define(&mut self, name: &str, file: &str, line: usize) -> Result<(), WarningKind> {
        if name.is_empty() {
            return Err(WarningKind::Nameless("newmtl"));
        }
        if self.names.contains_key(name) {
            return Err(WarningKind::DuplicateMaterial);
        }
        let id = MaterialId(self.entries.len() as u32);
        self.names.insert(name.to_owned(), id);
        let bare = without_comment(name);
        if bare != name {
            self.bare_names.entry(bare.to_owned()).or_insert(id);
        }
        self.entries.push(Entry {
            name: name.to_owned(),
            file: file.to_owned(),
            line,
            definition: Definition::default(),
        });
        Ok(())
    }
}

/// A library that is there, with what to say about where it was found; or why there is none.
type Found = Result<(PathBuf, Box<dyn Read>, Option<WarningKind>), WarningKind>;

/// The files that `name` means after `mtllib`: one name, which may hold spaces and end before a comment, or several.
fn find_files(folder: &Path, name: &str, open: Open<'_>) -> Vec<Found> {
    let exact = |name: &str| {
        let path = beside(folder, "mtllib", name).ok()?;
        open(&path, Some(folder)).ok().map(|text| (path, text))
    };
    let beside_model = |name: &str| exact(name.rsplit(['/', '\\', ':']).next().unwrap_or_default());
    let anywhere = |name: &str| {
        let here = exact(name).map(|(path, text)| (path, text, None));
        here.or_else(|| {
            let (path, text) = beside_model(name)?;
            Some((path, text, Some(WarningKind::LibraryElsewhere)))
        })
    };
    if let Some((path, text)) = exact(name) {
        return vec![Ok((path, text, None))];
    }
    let bare = without_comment(name);
    if bare.is_empty() {
        return vec![Err(WarningKind::Nameless("mtllib"))];
    }
    let comment = (bare != name).then_some(Err(WarningKind::CommentAfterName));
    let words: Vec<&str> = bare.split_whitespace().collect();
    let is_library = |word: &&str| word.to_ascii_lowercase().ends_with(".mtl");
    let several = words.len() > 1 && exact(bare).is_none() && words.iter().all(is_library);
    let one = if several { None } else { anywhere(bare) };
    let files: Vec<Found> = match one {
        Some(one) => vec![Ok(one)],
        None => words.iter().map(|w| anywhere(w).ok_or(WarningKind::MissingLibrary)).collect(),
    };
    comment.into_iter().chain(files).collect()
}

/// A name up to the `#` that begins a comment: the first one, or one after a space.
fn without_comment(name: &str) -> &str {
    let begins =
        |&(at, _): &(usize, &str)| name[..at].chars().next_back().is_none_or(char::is_whitespace);
    name.match_indices('#').find(begins).map_or(name, |(at, _)| name[..at].trim_end())
}

/// Statements about effects that are not in the slides: textures and the later "PBR" extension.
const IGNORED: [&str; 27] = [
    "map_Ka",
    "map_Kd",
    "map_Ks",
    "map_Ke",
    "map_Ns",
    "map_d",
    "map_Tr",
    "map_bump",
    "map_Bump",
    "map_Pr",
    "map_Pm",
    "map_Ps",
    "map_refl",
    "map_aat",
    "bump",
    "disp",
    "decal",
    "refl",
    "norm",
    "sharpness",
    "Pr",
    "Pm",
    "Ps",
    "Pc",
    "Pcr",
    "aniso",
    "anisor",
];
