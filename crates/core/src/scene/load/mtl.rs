use std::collections::HashMap;
use std::io::Read;
use std::path::{Path, PathBuf};

use super::check::{Problem, Range, beside, excerpt, in_range};
use super::clean::Lines;
use super::report::{LoadError, WarningKind, Warnings};
use super::{DEFAULT_GREY, Open};
use crate::Rgb;
use crate::scene::{Material, MaterialId, Pigment};

/// The materials of all libraries of one OBJ file.
///
/// Read here and not by tobj, which panics on short colours, names no line, and keeps two materials
/// of one name.
#[derive(Default)]
pub(super) struct Library {
    materials: Vec<Material>,
    names: HashMap<String, (MaterialId, String)>,
}

impl Library {
    /// The materials of the libraries that the OBJ file `model` names at the given lines.
    ///
    /// # Errors
    /// When a library is outside the model's folder, or its content is wrong.
    pub fn of_model(
        model: &Path,
        names: &[(String, usize)],
        open: Open<'_>,
        warnings: &mut Warnings,
    ) -> Result<Self, LoadError> {
        let mut library = Self::default();
        let file = model.display().to_string();
        let folder = model.parent().unwrap_or(Path::new(""));
        let mut paths: Vec<PathBuf> = Vec::new();
        for (name, line) in names {
            let place = |name| {
                beside(folder, "mtllib", name)
                    .map_err(|(problem, cure)| LoadError::at(&file, *line, problem, cure))
            };
            // One name with spaces, or several names.
            let whole = place(name)?;
            let words = name.split_whitespace();
            let candidates = if words.clone().count() > 1 && open(&whole).is_err() {
                words.map(place).collect::<Result<_, _>>()?
            } else {
                vec![whole]
            };
            for path in candidates {
                if paths.contains(&path) {
                    continue;
                }
                match open(&path) {
                    Ok(text) => library.read(&path.display().to_string(), text, warnings)?,
                    Err(_) => warnings.add(&file, *line, WarningKind::MissingLibrary),
                }
                paths.push(path);
            }
        }
        Ok(library)
    }

    pub fn find(&self, name: &str) -> Option<MaterialId> {
        self.names.get(name).map(|(id, _)| *id)
    }

    /// The materials with their names, in the order in which they are numbered.
    pub fn into_named(self) -> Vec<(String, Material)> {
        let mut names: Vec<_> = self.names.into_iter().map(|(name, (id, _))| (id, name)).collect();
        names.sort_unstable();
        names.into_iter().map(|(_, name)| name).zip(self.materials).collect()
    }

    /// Adds the materials of an MTL file.
    ///
    /// # Errors
    /// When a value is missing, not a number or out of range, or a name is used twice.
    fn read(
        &mut self,
        file: &str,
        text: Box<dyn Read + '_>,
        warnings: &mut Warnings,
    ) -> Result<(), LoadError> {
        let mut lines = Lines::new(file, text)?;
        let mut current: Option<Definition> = None;
        while let Some((number, line)) = lines.next()? {
            let statement = line.trim();
            let (keyword, rest) =
                statement.split_once(char::is_whitespace).unwrap_or((statement, ""));
            let invalid = |(problem, cure): Problem| LoadError::at(file, number, problem, cure);
            match keyword {
                "" | "Ka" => {}
                _ if keyword.starts_with('#') => {}
                "newmtl" => {
                    self.materials.extend(current.take().map(|done| done.material()));
                    self.define(rest.trim(), file, number).map_err(invalid)?;
                    current = Some(Definition::default());
                }
                "Kd" | "Ks" | "Ke" | "Tf" | "Ns" | "Ni" | "d" | "Tr" | "illum" => {
                    let words = rest.split('#').next().unwrap_or_default();
                    let material = current.as_mut().ok_or_else(|| invalid(outside(keyword)))?;
                    material.set(keyword, words).map_err(invalid)?;
                }
                _ => {
                    let ignored = IGNORED.iter().find(|&&ignored| ignored == keyword);
                    let kind =
                        ignored.map_or(WarningKind::UnknownStatement, |k| WarningKind::Ignored(k));
                    warnings.add(file, number, kind);
                }
            }
        }
        self.materials.extend(current.map(|done| done.material()));
        Ok(())
    }

    fn define(&mut self, name: &str, file: &str, line: usize) -> Result<(), Problem> {
        if name.is_empty() {
            return Err(("newmtl without a name".to_owned(), "name the material"));
        }
        if let Some((_, place)) = self.names.get(name) {
            let problem = format!("material `{}` is already defined at {place}", excerpt(name));
            return Err((problem, "rename one of the two"));
        }
        let id = MaterialId(self.materials.len() as u32);
        self.names.insert(name.to_owned(), (id, format!("{file}:{line}")));
        Ok(())
    }
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

fn outside(keyword: &str) -> Problem {
    (format!("`{keyword}` before the first newmtl"), "start the material with `newmtl NAME`")
}

/// What an MTL file says about one material.
#[derive(Default)]
struct Definition {
    kd: Option<Rgb>,
    ks: Option<Rgb>,
    ke: Option<Rgb>,
    tf: Option<Rgb>,
    ns: Option<f64>,
    ni: Option<f64>,
    /// `d`, and 1 − `Tr`: some exporters write both and mean `d`.
    d: Option<f64>,
    tr: Option<f64>,
    illum: Option<f64>,
}

impl Definition {
    fn set(&mut self, keyword: &str, words: &str) -> Result<(), Problem> {
        let number = |range| in_range(keyword, scalar(keyword, words)?, range);
        let color = |range| {
            let color = rgb(keyword, words)?;
            for channel in color.to_array() {
                in_range(keyword, channel, range)?;
            }
            Ok(color)
        };
        match keyword {
            "Kd" => self.kd = Some(color(Range::Share)?),
            "Ks" => self.ks = Some(color(Range::Share)?),
            "Tf" => self.tf = Some(color(Range::Share)?),
            "Ke" => self.ke = Some(color(Range::Radiance)?),
            "Ns" => self.ns = Some(number(Range::NotNegative)?),
            "Ni" => self.ni = Some(number(Range::Index)?),
            "d" => self.d = Some(number(Range::Share)?),
            "Tr" => self.tr = Some(number(Range::Share)?),
            _ => self.illum = Some(number(Range::Illum)?),
        }
        Ok(())
    }

    /// The material in the course's terms, after the formulas of the MTL specification:
    ///
    /// | `illum`    | specification                        | here                                 |
    /// |------------|--------------------------------------|--------------------------------------|
    /// | 0, 1       | Kd, no highlight                     | ρ_d = Kd                             |
    /// | 2, 8, 10   | and highlight Ks (Σ(H·Hⱼ)^Ns Iⱼ)     | and ρ_s = Ks, n = Ns                 |
    /// | 3, 5       | and mirror Ks (Σ … + I_r)            | and k_s = Ks                         |
    /// | 4, 9       | as 3, as 2; *glass*, not refracting  | k_t = (1 − d) Tf, index 1            |
    /// | 6, 7       | Ks (Σ … + I_r) + (1 − Ks) Tf I_t     | k_s = Ks, k_t = (1 − Ks) Tf, index Ni |
    ///
    /// `d` mixes the surface with what is behind it: every other term is multiplied by d and, up to
    /// `illum` 5, k_t is (1 − d) Tf with index 1, since only 6 and 7 refract and exporters write
    /// `Ni` everywhere. Glass keeps its highlight and mirror at full strength. The Fresnel factors
    /// of 5 and 7 are left out. `Ka` is not read: the course's ambient term is ρ̄ I_a.
    /// Without `illum` a material is of kind 2; without `Kd` it is light grey, without `Ns` its
    /// exponent is 1.
    fn material(&self) -> Material {
        let opacity = self.d.or(self.tr.map(|tr| 1.0 - tr)).unwrap_or(1.0);
        let kd = self.kd.unwrap_or(DEFAULT_GREY);
        let ks = self.ks.unwrap_or(Rgb::ZERO);
        let tf = self.tf.unwrap_or(Rgb::ONE);
        let illum = self.illum.map_or(2, |illum| illum as u8);

        let refracts = matches!(illum, 6 | 7);
        let kept = if refracts || matches!(illum, 4 | 9) { 1.0 } else { opacity };
        let shines = illum >= 2;
        let mirrors = matches!(illum, 3..=7);
        Material {
            rho_d: Pigment::Solid(opacity * kd),
            rho_s: if shines { kept * ks } else { Rgb::ZERO },
            shininess: self.ns.unwrap_or(1.0),
            k_s: if mirrors { kept * ks } else { Rgb::ZERO },
            k_t: if refracts { (Rgb::ONE - ks) * tf } else { (1.0 - opacity) * tf },
            refractive_index: if refracts { self.ni.unwrap_or(1.0) } else { 1.0 },
            emission: self.ke.unwrap_or(Rgb::ZERO),
        }
    }
}

fn scalar(keyword: &str, words: &str) -> Result<f64, Problem> {
    match numbers(keyword, words)?[..] {
        [value] => Ok(value),
        _ => Err(wrong_count(keyword, words, "give it one number")),
    }
}

/// One number is a grey, as the specification says.
fn rgb(keyword: &str, words: &str) -> Result<Rgb, Problem> {
    match numbers(keyword, words)?[..] {
        [grey] => Ok(Rgb::splat(grey)),
        [r, g, b] => Ok(Rgb::new(r, g, b)),
        _ => Err(wrong_count(keyword, words, "give it one number or three")),
    }
}

fn numbers(keyword: &str, words: &str) -> Result<Vec<f64>, Problem> {
    let number = |word: &str| {
        let problem = || {
            (
                format!("{keyword}: `{}` is not a number", excerpt(word)),
                "write a number, with a decimal point",
            )
        };
        word.parse().map_err(|_| problem())
    };
    words.split_whitespace().map(number).collect()
}

fn wrong_count(keyword: &str, words: &str, cure: &'static str) -> Problem {
    (format!("{keyword} has {} numbers", words.split_whitespace().count()), cure)
}
