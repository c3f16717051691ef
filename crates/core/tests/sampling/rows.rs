//! Rectangular lamps of radiance 1 with their irradiances in closed form.

use glam::DVec3;
use lancer_core::sampling::{Patch, Rectangle};

/// A lamp and a receiver. E is Lambert's formula on the polygon above the horizon; deviations, over E, and kurtoses
/// of one sample are exact moments, by Gauss quadrature.
pub struct Row {
    pub name: &'static str,
    pub corner: DVec3,
    pub edges: [DVec3; 2],
    /// The receiver and its normal.
    pub from: DVec3,
    pub n: DVec3,
    pub irradiance: f64,
    pub solid_angle: f64,
    /// Deviation and kurtosis by area.
    pub by_area: [f64; 2],
    /// The same by solid angle.
    pub by_solid_angle: [f64; 2],
    /// What the ratio κ of the farthest to the nearest distance decides.
    pub is_near: bool,
}

impl Row {
    pub fn patch(&self) -> Patch {
        let [left, right] = self.edges.map(|edge| self.corner + edge);
        let opposite = left + self.edges[1];
        Patch::new([[self.corner, left, right], [opposite, right, left]]).unwrap()
    }

    /// The same, from the same corners.
    pub fn rectangle(&self) -> Rectangle {
        let edges = self.edges.map(|edge| (self.corner + edge) - self.corner);
        Rectangle::new(self.corner, edges).unwrap()
    }

    /// cos θ of the direction to a point, 0 below the horizon.
    pub fn cosine(&self, point: DVec3) -> f64 {
        (point - self.from).normalize().dot(self.n).max(0.0)
    }
}

/// A horizontal rectangle that shines down, around (x, y).
fn ceiling([x, y]: [f64; 2], [width, depth]: [f64; 2], height: f64) -> (DVec3, [DVec3; 2]) {
    let corner = DVec3::new(x - 0.5 * width, y - 0.5 * depth, height);
    (corner, [depth * DVec3::Y, width * DVec3::X])
}

fn tilted(degrees: f64) -> DVec3 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    DVec3::new(sin, 0.0, cos)
}

pub fn rows() -> Vec<Row> {
    let centred = ceiling([0.0, 0.0], [1.0, 1.0], 1.0);
    let wall = (DVec3::new(1.0, -0.5, -1.0), [2.0 * DVec3::Z, DVec3::Y]);
    // The lamp of Mitsuba's Cornell box.
    let cornell = (DVec3::new(-0.23, 0.99, -0.18), [0.46 * DVec3::X, 0.38 * DVec3::Z]);
    let at = |x, y, z| DVec3::new(x, y, z);
    type Numbers = (f64, f64, [f64; 2], [f64; 2]);
    let row = |name, (corner, edges), from, n, is_near, numbers: Numbers| {
        let (irradiance, solid_angle, by_area, by_solid_angle) = numbers;
        Row {
            name,
            corner,
            edges,
            from,
            n,
            irradiance,
            solid_angle,
            by_area,
            by_solid_angle,
            is_near,
        }
    };
    let o = DVec3::ZERO;
    #[rustfmt::skip]
    let rows = vec![
        row("R1", centred, o, DVec3::Z, false, (0.752274688454107, 0.805431683161323, [0.174225, 2.102], [0.0432797, 2.297])),
        row("R2", centred, o, tilted(30.0), false, (0.651488990825281, 0.805431683161323, [0.230177, 2.225], [0.161081, 2.034])),
        row("R3", centred, o, tilted(60.0), false, (0.376137344227054, 0.805431683161323, [0.483733, 1.812], [0.467481, 1.834])),
        row("R4", centred, o, tilted(80.0), false, (0.164592344981967, 0.805431683161323, [0.92586, 1.491], [0.95315, 1.729])),
        row("R5", centred, o, tilted(110.0), false, (0.00527400279461842, 0.805431683161323, [2.9353, 11.28], [3.2061, 13.62])),
        row("R6", ceiling([1.5, 0.0], [1.0, 1.0], 1.0), o, DVec3::Z, true, (0.104637075190907, 0.179532583341692, [0.518085, 2.444], [0.123277, 1.899])),
        row("R7", ceiling([0.0, 0.0], [2.0, 2.0], 0.1), o, DVec3::Z, true, (3.11610061840345, 5.71984181291392, [6.49142, 164.2], [0.482509, 1.801])),
        row("R8", ceiling([0.3, 0.2], [0.01, 0.01], 1.0), o, DVec3::Z, false, (7.83131555006401e-5, 8.32483223018533e-5, [0.0036843, 2.311], [0.00092107, 2.311])),
        row("R9", ceiling([0.0, 1.0], [4.0, 0.1], 1.0), o, DVec3::Z, true, (0.0504944903005609, 0.0816921528510279, [0.598689, 1.709], [0.138331, 2.467])),
        row("R10", wall, o, DVec3::Z, true, (0.223346625828318, 1.28700221758657, [1.12614, 1.378], [1.2913, 2.381])),
        row("C1", cornell, at(0.0, -1.0, 0.01), DVec3::Y, false, (0.0434892920927439, 0.04365076512073, [0.00953974, 2.472], [0.00238489, 2.5])),
        row("C2", cornell, at(0.8, -1.0, 0.8), DVec3::Y, false, (0.0252840005847290, 0.029033510737311, [0.104461, 2.381], [0.0260557, 2.347])),
        row("C3", cornell, at(0.0, 0.5, -1.0), DVec3::Z, true, (0.0548115816120914, 0.0618796160417441, [0.239758, 1.984], [0.0239057, 1.994])),
        row("C4", cornell, at(-1.0, 0.9, 0.01), DVec3::X, true, (0.0167476822193879, 0.0169407692501746, [0.39918, 2.306], [0.00685557, 3.286])),
        row("C5", cornell, at(-1.0, -0.5, 0.5), DVec3::X, false, (0.0213844007834744, 0.0404594687394, [0.0656187, 1.973], [0.0974794, 1.856])),
    ];
    rows
}
