use super::DEFAULT_GREY;
use super::check::{Problem, Range, excerpt, in_range};
use super::report::WarningKind;
use crate::Rgb;
use crate::scene::{Material, Pigment};

/// A value as its statement gives it, or the line and what is wrong there: a model is refused for it only if a
/// picture needs the value.
type Given<T> = Option<Result<T, (usize, Problem)>>;

/// What an MTL file says about one material.
#[derive(Default)]
pub(super) struct Definition {
    kd: Given<Rgb>,
    ks: Given<Rgb>,
    ke: Given<Rgb>,
    tf: Given<Rgb>,
    ns: Given<f64>,
    ni: Given<f64>,
    /// `d`, and `Tr`, which is 1 − d: some exporters write both and mean `d`.
    d: Given<f64>,
    tr: Given<f64>,
    illum: Option<u8>,
}

impl Definition {
    /// The statements that are read, beside `Ka`.
    pub const KEYWORDS: [&str; 9] = ["Kd", "Ks", "Ke", "Tf", "Ns", "Ni", "d", "Tr", "illum"];

    /// Takes a statement of one of the `KEYWORDS`; what is odd about it and can be passed over is told to `warn`.
    pub fn set(
        &mut self,
        keyword: &str,
        words: &str,
        line: usize,
        warn: &mut dyn FnMut(WarningKind),
    ) {
        let mut words: Vec<&str> = words.split_whitespace().collect();
        let most = match keyword {
            "Kd" | "Ks" | "Ke" | "Tf" if matches!(words[..], ["spectral" | "xyz", ..]) => {
                return warn(WarningKind::ForeignColor);
            }
            "Kd" | "Ks" | "Ke" | "Tf" => 3,
            _ => 1,
        };
        if keyword == "d" && words.first() == Some(&"-halo") {
            warn(WarningKind::Halo);
            words.remove(0);
        }
        if words.len() > most {
            warn(WarningKind::ExtraNumbers);
            words.truncate(most);
        }
        let at_line = |problem| (line, problem);
        let number = |range| {
            let read = scalar(keyword, &words).and_then(|value| in_range(keyword, value, range));
            Some(read.map_err(at_line))
        };
        let color = |range| {
            let read = rgb(keyword, &words).and_then(|color| {
                color
                    .to_array()
                    .into_iter()
                    .try_for_each(|c| in_range(keyword, c, range).map(drop))?;
                Ok(color)
            });
            Some(read.map_err(at_line))
        };
        match keyword {
            "Kd" => self.kd = color(Range::Share),
            "Ks" => self.ks = color(Range::Share),
            "Tf" => self.tf = color(Range::Share),
            "Ke" => self.ke = color(Range::Radiance),
            "Ns" => {
                self.ns = match scalar(keyword, &words) {
                    Ok(value) if value < 0.0 && value.is_finite() => {
                        warn(WarningKind::NegativeShininess);
                        Some(Ok(0.0))
                    }
                    _ => number(Range::NotNegative),
                }
            }
            "Ni" => self.ni = number(Range::Index),
            "d" => self.d = number(Range::Share),
            "Tr" => self.tr = number(Range::Share),
            _ => match number(Range::Illum) {
                Some(Ok(illum)) => self.illum = Some(illum as u8),
                _ => warn(WarningKind::UnknownIllum),
            },
        }
    }

    /// The material in the course's terms, after the formulas of the MTL specification:
    ///
    /// | `illum`    | specification                        | here                                 |
    /// |------------|--------------------------------------|--------------------------------------|
    /// | 0, 1       | Kd, no highlight                     | ρ_d = Kd                             |
    /// | 2, 8, 10   | and highlight Ks (Σ(H·Hⱼ)^Ns Iⱼ)     | and ρ_s = Ks, n by [`exponent`]      |
    /// | 3, 5       | and mirror Ks (Σ … + I_r)            | and k_s = Ks                         |
    /// | 4, 9       | as 3, as 2; *glass*, not refracting  | k_t = (1 − d) Tf, index 1            |
    /// | 6, 7       | Ks (Σ … + I_r) + (1 − Ks) Tf I_t     | k_s = Ks, k_t = (1 − Ks) Tf, index Ni |
    ///
    /// `d` mixes the surface with what is behind it: every other term is multiplied by d and, up to
    /// `illum` 5, k_t is (1 − d) Tf with index 1, since only 6 and 7 refract and exporters write
    /// `Ni` everywhere. Glass keeps its highlight and mirror at full strength. The Fresnel factors
    /// of 5 and 7 are left out. `Ka` is not read: the course's ambient term is ρ̄ I_a.
    /// Without `illum` a material is of kind 2; without `Kd` it is light grey, without `Ns` its
    /// highlight is the widest.
    ///
    /// # Errors
    /// The line and the problem of a wrong value that this kind of material needs.
    pub fn material(&self) -> Result<Material, (usize, Problem)> {
        let opacity = match (&self.d, &self.tr) {
            (None, tr) => 1.0 - value(tr, 0.0, true)?,
            (d, _) => value(d, 1.0, true)?,
        };
        let illum = self.illum.unwrap_or(2);
        let refracts = matches!(illum, 6 | 7);
        let kept = if refracts || matches!(illum, 4 | 9) { 1.0 } else { opacity };
        let shines = illum >= 2;
        let mirrors = matches!(illum, 3..=7);

        let kd = value(&self.kd, DEFAULT_GREY, true)?;
        let ks = value(&self.ks, Rgb::ZERO, shines)?;
        let tf = value(&self.tf, Rgb::ONE, refracts || opacity < 1.0)?;
        Ok(Material {
            rho_d: Pigment::Solid(opacity * kd),
            rho_s: if shines { kept * ks } else { Rgb::ZERO },
            shininess: exponent(value(&self.ns, 0.0, shines && ks != Rgb::ZERO)?),
            k_s: if mirrors { kept * ks } else { Rgb::ZERO },
            k_t: if refracts { (Rgb::ONE - ks) * tf } else { (1.0 - opacity) * tf },
            gloss: None,
            refractive_index: if refracts { value(&self.ni, 1.0, true)? } else { 1.0 },
            emission: value(&self.ke, Rgb::ZERO, true)?,
        })
    }

    /// Reads `d` and `Tr` the other way round.
    pub fn exchange_opacity(&mut self) {
        let opacity = self.d.take().map(|d| d.map(|d| 1.0 - d));
        self.d = opacity.or(self.tr.take());
    }

    /// The lines of the wrong values, in order.
    pub fn wrong_lines(&self) -> Vec<usize> {
        fn line<T>(given: &Given<T>) -> Option<usize> {
            given.as_ref()?.as_ref().err().map(|(line, _)| *line)
        }
        let colors = [&self.kd, &self.ks, &self.ke, &self.tf].map(line);
        let numbers = [&self.ns, &self.ni, &self.d, &self.tr].map(line);
        let mut lines: Vec<usize> = colors.into_iter().chain(numbers).flatten().collect();
        lines.sort_unstable();
        lines
    }
}

/// n of the slides' (R·V)ⁿ for the exponent of MTL's (N·H)^Ns: [the module](super#highlights-of-mtl-files) says why,
/// and how exact it is.
pub(super) fn exponent(ns: f64) -> f64 {
    (ns / 4.0).max(1.0)
}

/// The value, or the default where none is given. A wrong one that is not `needed` counts as not given.
fn value<T: Copy>(given: &Given<T>, default: T, needed: bool) -> Result<T, (usize, Problem)> {
    match given {
        Some(Ok(value)) => Ok(*value),
        Some(Err(problem)) if needed => Err(problem.clone()),
        _ => Ok(default),
    }
}

fn scalar(keyword: &str, words: &[&str]) -> Result<f64, Problem> {
    match numbers(keyword, words)?[..] {
        [value] => Ok(value),
        _ => Err(wrong_count(keyword, words, "give it one number")),
    }
}

/// One number is a grey, as the specification says.
fn rgb(keyword: &str, words: &[&str]) -> Result<Rgb, Problem> {
    match numbers(keyword, words)?[..] {
        [grey] => Ok(Rgb::splat(grey)),
        [r, g, b] => Ok(Rgb::new(r, g, b)),
        _ => Err(wrong_count(keyword, words, "give it one number or three")),
    }
}

fn numbers(keyword: &str, words: &[&str]) -> Result<Vec<f64>, Problem> {
    let number = |word: &&str| {
        let problem = || {
            (
                format!("{keyword}: `{}` is not a number", excerpt(word)),
                "write a number, with a decimal point",
            )
        };
        word.parse().map_err(|_| problem())
    };
    words.iter().map(number).collect()
}

fn wrong_count(keyword: &str, words: &[&str], cure: &'static str) -> Problem {
    (format!("{keyword} has {} numbers", words.len()), cure)
}
