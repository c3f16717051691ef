use std::collections::HashMap;
use std::fmt;
use std::io;

/// Why a scene could not be read. Displays as one line: `file:line: what is wrong; cure`.
#[derive(Debug, thiserror::Error)]
pub enum LoadError {
    /// The system refused to open or read a file.
    #[error("{}: {reason}; check the path and its permissions", place(file, None))]
    Unreadable {
        /// The file as it was asked for.
        file: String,
        /// The system's answer.
        reason: io::Error,
    },
    /// A folder has that name.
    #[error("{}: it is a folder; name a .obj or .toml file in it", place(file, None))]
    IsFolder {
        /// The file as it was asked for.
        file: String,
    },
    /// The extension names no kind of scene.
    #[error("{}: unknown kind of scene; the known ones are .obj and .toml", place(file, None))]
    UnknownKind {
        /// The file as it was asked for.
        file: String,
    },
    /// The content is wrong.
    #[error("{}: {}; {}", place(file, *line), printable(problem), printable(cure))]
    Invalid {
        /// The file the content stands in.
        file: String,
        /// The line, from 1, where one can be named.
        line: Option<usize>,
        /// What is wrong.
        problem: String,
        /// What to do about it.
        cure: String,
    },
}

impl LoadError {
    pub(super) fn at(
        file: &str,
        line: impl Into<Option<usize>>,
        problem: impl Into<String>,
        cure: impl Into<String>,
    ) -> Self {
        Self::Invalid {
            file: file.to_owned(),
            line: line.into(),
            problem: problem.into(),
            cure: cure.into(),
        }
    }

    /// The line, where one can be named, and what is wrong there.
    pub(super) fn into_parts(self) -> (Option<usize>, String) {
        match self {
            Self::Unreadable { reason, .. } => (None, reason.to_string()),
            Self::Invalid { line, problem, .. } => (line, problem),
            Self::IsFolder { .. } | Self::UnknownKind { .. } => (None, self.to_string()),
        }
    }
}

fn place(file: &str, line: Option<usize>) -> String {
    let file = printable(file);
    line.map_or_else(|| file.clone(), |line| format!("{file}:{line}"))
}

/// Text from a file, as one line that cannot control a terminal.
fn printable(text: &str) -> String {
    text.replace(char::is_control, "\u{fffd}")
}

/// What was ignored, replaced, or looks wrong without stopping the scene from being drawn.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum WarningKind {
    /// A statement of this keyword describes what the course has not, such as a texture.
    Ignored(&'static str),
    /// A statement that the format does not know: a typing error, or a foreign extension.
    UnknownStatement,
    /// Lines, points, curves and surfaces of an OBJ: only its faces are drawn.
    NotAFace,
    /// Vertex colours of an OBJ; colours come from materials.
    VertexColors,
    /// `usemtl`, `mtllib` or `newmtl` without a name.
    Nameless(&'static str),
    /// The name after `usemtl` or `mtllib`, or that of the material, ends before a comment.
    CommentAfterName,
    /// A material library that does not exist or cannot be opened, or a link to one outside the model's folder.
    MissingLibrary,
    /// A material library that is there but cannot be read, or not to its end; what stands before counts.
    UnreadableLibrary {
        /// Why.
        reason: String,
    },
    /// A material library that is not where the model says, or outside its folder; one of the same name beside
    /// the model was read.
    LibraryElsewhere,
    /// A material whose name is taken; the first counts.
    DuplicateMaterial,
    /// A statement of a material before the first `newmtl`.
    BeforeMaterial,
    /// A colour as a spectral curve or as CIE XYZ; it counts as not given.
    ForeignColor,
    /// `d -halo`: a dissolve that depends on the direction.
    Halo,
    /// More numbers than the statement has.
    ExtraNumbers,
    /// An `Ns` below 0, as Blender wrote it for years.
    NegativeShininess,
    /// An `illum` that the specification has not.
    UnknownIllum,
    /// A value that cannot be read or is out of range, of which no picture depends.
    UnneededValue,
    /// A library all of whose materials would be invisible, because its writer means the opposite by `Tr` or `d`.
    InvisibleLibrary,
    /// `usemtl` names a material that no library defines.
    UnknownMaterial,
    /// A face with fewer than three corners.
    TooFewCorners,
    /// A face with normals at some of its corners only.
    PartialNormals,
    /// A face that names a normal that does not exist, or one without a direction.
    UnusableNormals,
    /// A polygon that crosses itself, so that its area has no meaning.
    SelfIntersecting,
    /// A polygon whose corners are far from any plane.
    NonPlanar,
    /// A triangle of no area. It is kept: it closes the seam between neighbours of unequal detail.
    ZeroArea,
    /// Nothing in the scene shines.
    NoLight,
    /// A material that sends back more light than it receives, so that the light between two of them grows
    /// without end.
    Amplifies {
        /// Its name.
        material: String,
        /// The share that it sends back, as a decimal fraction.
        sum: String,
    },
    /// A material of which nothing is seen.
    Invisible {
        /// Its name.
        material: String,
    },
    /// A refracting surface with borders: what enters it may never leave it, and the other way round.
    OpenSurface {
        /// The name of its material.
        material: String,
        /// The edges of one triangle, or of an odd number of triangles of one material.
        edges: usize,
    },
    /// A refracting surface whose outside and inside are exchanged from one triangle to the next.
    MixedWinding {
        /// The name of its material.
        material: String,
        /// The edges along which neighbours run in the same direction.
        edges: usize,
    },
    /// A closed refracting surface whose normals point inwards, and which is no hole in another one.
    InsideOut {
        /// The name of its material.
        material: String,
        /// Its edges, with those of all others of this material.
        edges: usize,
    },
}

impl fmt::Display for WarningKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Ignored(keyword) => write!(f, "`{keyword}` is ignored: the course has no such effect"),
            Self::UnknownStatement => f.write_str("unknown statement ignored"),
            Self::NotAFace => f.write_str("lines, points, curves and surfaces ignored: only faces are drawn"),
            Self::VertexColors => f.write_str("vertex colours ignored: colours come from materials"),
            Self::Nameless(keyword) => {
                write!(f, "`{keyword}` without a name; what it should name becomes light grey")
            }
            Self::CommentAfterName => f.write_str("the name is taken to end before its ` #`, a comment"),
            Self::LibraryElsewhere => f.write_str(
                "material library is not in this file's folder under that path; the one of its name beside this file is read",
            ),
            Self::DuplicateMaterial => {
                f.write_str("a material of this name is defined already; the first one counts")
            }
            Self::BeforeMaterial => f.write_str("statement before the first `newmtl` ignored"),
            Self::ForeignColor => {
                f.write_str("spectral and xyz colours are ignored: write red, green and blue")
            }
            Self::Halo => f.write_str("`d -halo` is read as `d`, the same from all sides"),
            Self::ExtraNumbers => f.write_str("more numbers than the statement has; the first ones count"),
            Self::NegativeShininess => f.write_str("a negative `Ns` counts as 0"),
            Self::UnknownIllum => {
                f.write_str("`illum` is not a whole number from 0 to 10, and counts as not given")
            }
            Self::UnneededValue => {
                f.write_str("wrong value ignored: no picture of this model depends on it")
            }
            Self::InvisibleLibrary => f.write_str(
                "every material of this library would be invisible; `Tr` and `d` are read the other way round, \
                 as some exporters write them",
            ),
            Self::MissingLibrary => {
                f.write_str("material library cannot be opened; its materials become light grey")
            }
            Self::UnreadableLibrary { reason } => write!(
                f,
                "material library cannot be read to its end: {}; what is missing becomes light grey",
                printable(reason)
            ),
            Self::UnknownMaterial => {
                f.write_str("material not defined in any library; its faces become light grey")
            }
            Self::TooFewCorners => f.write_str("face with fewer than 3 corners left out"),
            Self::PartialNormals => f.write_str("face with normals at some corners only is drawn flat"),
            Self::UnusableNormals => f.write_str(
                "face with a normal that does not exist, is zero or not finite is drawn flat",
            ),
            Self::SelfIntersecting => f.write_str("polygon crosses itself; split it to get the right area"),
            Self::NonPlanar => f.write_str("polygon is not planar; split it into triangles"),
            Self::ZeroArea => f.write_str("triangle of zero area (kept)"),
            Self::Amplifies { material, sum } => write!(
                f,
                "material `{}` sends back {sum} times the light that it receives, by ρ_d + 2 ρ_s/(n + 1) + k_s + k_t; \
                 keep the sum at 1 or below",
                printable(material)
            ),
            Self::Invisible { material } => write!(
                f,
                "material `{}` is invisible: light passes as if it were not there; check `d` and `Tr`, or `k_t`",
                printable(material)
            ),
            Self::OpenSurface { material, edges } => write!(
                f,
                "the refracting surface `{}` is open, at {edges} of its edges: what enters may never leave; \
                 close it, or give it the refractive index 1",
                printable(material)
            ),
            Self::MixedWinding { material, edges } => write!(
                f,
                "the refracting surface `{}` exchanges inside and outside, at {edges} of its edges; \
                 turn its faces counter-clockwise seen from outside",
                printable(material)
            ),
            Self::InsideOut { material, edges } => write!(
                f,
                "the refracting surface `{}` is inside out, at all of its {edges} edges; \
                 turn its faces counter-clockwise seen from outside",
                printable(material)
            ),
            Self::NoLight => f.write_str(
                "no light: the picture will be black; add a [[light]], a material with emission or an ambient",
            ),
        }
    }
}

/// All findings of one kind in one file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// The file they were found in.
    pub file: String,
    /// The line of the first, from 1, where one can be named.
    pub line: Option<usize>,
    /// What was found.
    pub kind: WarningKind,
    /// How often.
    pub count: usize,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", place(&self.file, self.line), self.kind)?;
        if self.count > 1 {
            write!(f, " ({} times, this is the first)", self.count)
        } else {
            Ok(())
        }
    }
}

/// Counts findings, one [`Warning`] per file and kind in order of first appearance.
#[derive(Default)]
pub(super) struct Warnings {
    list: Vec<Warning>,
    index: HashMap<(String, WarningKind), usize>,
}

impl Warnings {
    pub fn add(&mut self, file: &str, line: impl Into<Option<usize>>, kind: WarningKind) {
        self.add_many(file, line, kind, 1);
    }

    pub fn add_many(
        &mut self,
        file: &str,
        line: impl Into<Option<usize>>,
        kind: WarningKind,
        count: usize,
    ) {
        let index = *self.index.entry((file.to_owned(), kind.clone())).or_insert_with(|| {
            self.list.push(Warning { file: file.to_owned(), line: line.into(), kind, count: 0 });
            self.list.len() - 1
        });
        self.list[index].count += count;
    }

    pub fn into_vec(self) -> Vec<Warning> {
        self.list
    }
}
