//! 1.2: the picture built up term by term, and the terms' sum against the picture.

use lancer_accel::ObvhsBvh2;
use lancer_core::Rgb;
use lancer_core::geometry::Interval;
use lancer_core::illumination::{Reflectance, ambient};
use lancer_core::image::{Image, ImageSize};
use lancer_core::intersector::Intersector;
use lancer_core::optics::Branches;
use lancer_core::scene::Scene;
use lancer_core::world::World;
use lancer_figure::{
    BarChart, Effort, Finished, Montage, Plate, Row, Table, Tile, category_color, number,
};
use lancer_lesson::picture::shown;
use lancer_whitted::{AtLimit, Settings, Whitted};

use crate::scenes;

const TERMS: [&str; 6] = ["ambient", "diffuse", "specular", "shadows", "reflection", "refraction"];

pub fn make(effort: Effort) -> Finished {
    let scene = scenes::whitted();
    let size = effort.pick(ImageSize::new(48, 48), ImageSize::new(320, 320));
    let (terms, picture) = terms_of(&scene, size);

    let largest = terms
        .iter()
        .zip(&picture)
        .map(|(terms, whole)| (terms.iter().sum::<Rgb>() - *whole).abs().max_element())
        .fold(0.0, f64::max);
    let brightest = picture.iter().map(|p| p.max_element()).fold(0.0, f64::max);
    // Rounding of R·V grows with the exponent of the highlight.
    let exponent = scene.materials.iter().map(|material| material.shininess).fold(1.0, f64::max);
    let holds = largest <= 2.0 * exponent * f64::EPSILON * brightest;
    let claim = format!(
        "The six terms add up to Whitted's picture: no pixel differs by more than {}, \
         which is rounding.",
        number(largest)
    );

    let mut montage = Montage::new().columns(3);
    let mut sums = vec![Rgb::ZERO; terms.len()];
    for (k, name) in TERMS.iter().enumerate() {
        for (sum, terms) in sums.iter_mut().zip(&terms) {
            *sum += terms[k];
        }
        let pixels = sums.iter().map(|p| p.as_vec3().to_array()).collect();
        let title = if k == 0 { "ambient + background".to_owned() } else { format!("+ {name}") };
        montage = montage.tile(
            Tile::new(title, shown(&Image::from_pixels(size, pixels))).color(category_color(k)),
        );
    }

    let mut data = Table::new(["term", "mean_radiance", "share"]);
    let count = terms.len() as f64;
    let mean = |of: &dyn Fn(&[Rgb; 6]) -> Rgb| {
        terms.iter().map(|t| of(t).element_sum() / 3.0).sum::<f64>() / count
    };
    let total = mean(&|t| t.iter().sum());
    let means: Vec<f64> = (0..TERMS.len()).map(|k| mean(&|t| t[k])).collect();
    for (name, value) in TERMS.iter().zip(&means) {
        data.push([(*name).into(), (*value).into(), (value / total).into()]);
    }
    let bars = BarChart::new("mean of the picture (radiance)", TERMS)
        .title("What each term changes (« ambient » with the background)")
        .stacked()
        .series("adds", category_color(0), means.iter().map(|m| m.max(0.0)).collect::<Vec<_>>())
        .series(
            "takes",
            category_color(3),
            means.iter().map(|m| (-m).max(0.0)).collect::<Vec<_>>(),
        );

    let plate = Plate::new("1.2", "The local model, term by term", claim, holds)
        .panel(montage)
        .panel(Row::new().panel(1.0, bars))
        .note("Method", "eq:ambient, eq:local with ρ_d and ρ_s apart, eq:attenuation, eq:recursion; each \
             picture adds one term to those before, « shadows » takes back the light that vis(i) = 0 stops")
        .note("Settings", format!("scene whitted, {size}, 1 sample per pixel, depth 5"))
        .note("Reference", "algo:lr to depth 5, which knows nothing of the terms; reflection and refraction are \
             algo:lr to depth 4 from the surface on");
    Finished { plate, data }
}

/// Every ray is followed, so that both ways of counting follow the same ones.
const WHOLE: Settings = Settings { max_depth: 5, min_weight: 0.0, at_limit: AtLimit::Black };
/// What is left of it after the first bounce.
const REST: Settings = Settings { max_depth: WHOLE.max_depth - 1, ..WHOLE };

/// For each pixel the six terms of what its ray brings back, and what Whitted's method says of it.
fn terms_of(scene: &Scene, size: ImageSize) -> (Vec<[Rgb; 6]>, Vec<Rgb>) {
    let index = ObvhsBvh2::build(scene);
    let world = World { scene, index: &index };
    let (whole, rest) = (Whitted::new(world, WHOLE), Whitted::new(world, REST));
    let rays = scene.camera.primary_rays(size);
    let sources = scene.point_sources();
    let pixels = (0..size.height).flat_map(|y| (0..size.width).map(move |x| (x, y)));
    pixels
        .map(|(x, y)| {
            let ray = rays.through(f64::from(x) + 0.5, f64::from(y) + 0.5);
            let radiance = whole.trace(&ray, &mut ());
            let mut terms = [Rgb::ZERO; 6];
            let Some(hit) = index.closest_hit(&ray, Interval::POSITIVE) else {
                terms[0] = scene.background;
                return (terms, radiance);
            };
            let surface = scene.surface_at(&ray, &hit);
            let material = scene.material(surface.material);
            let incident = ray.direction;
            let n = surface.shading_normal_towards(-incident);
            let both = scene.reflectance(&surface);
            let matte = Reflectance { specular: Rgb::ZERO, ..both };
            let shiny = Reflectance { diffuse: Rgb::ZERO, ..both };
            terms[0] = material.emission + ambient(both.diffuse, scene.ambient);
            for source in &sources {
                let light = source.arriving(&surface);
                let lit = |reflectance| light.unshadowed(reflectance, n, -incident);
                let (diffuse, specular) = (lit(&matte), lit(&shiny));
                terms[1] += diffuse;
                terms[2] += specular;
                if index.occluded(&light.shadow_ray, Interval::up_to(1.0)) {
                    terms[3] -= diffuse + specular;
                }
            }
            let beyond =
                |(share, direction)| share * rest.trace(&surface.spawn(direction), &mut ());
            let branches = Branches::new(&surface, material, incident);
            terms[4] = branches.mirror.map_or(Rgb::ZERO, beyond);
            terms[5] = branches.refracted.map_or(Rgb::ZERO, beyond);
            (terms, radiance)
        })
        .unzip()
}
