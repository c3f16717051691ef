//! The right answers: the chapter's solutions, each of which is a student's file. `tests/solutions.rs` compares them
//! with the course's own code.

#[path = "../../solutions/e01_primary_ray.rs"]
mod e01_primary_ray;
#[path = "../../solutions/e02_ray_triangle.rs"]
mod e02_ray_triangle;
#[path = "../../solutions/e03_ray_sphere.rs"]
mod e03_ray_sphere;
#[path = "../../solutions/e04_shadow_ray.rs"]
mod e04_shadow_ray;
#[path = "../../solutions/e05_local_light.rs"]
mod e05_local_light;
#[path = "../../solutions/e06_reflected_ray.rs"]
mod e06_reflected_ray;
#[path = "../../solutions/e07_refracted_ray.rs"]
mod e07_refracted_ray;
#[path = "../../solutions/e08_lr.rs"]
mod e08_lr;
#[path = "../../solutions/e09_ray_tree.rs"]
mod e09_ray_tree;
#[path = "../../solutions/e10_samples.rs"]
mod e10_samples;

use super::Subject;

pub use e01_primary_ray::primary_ray;
pub use e02_ray_triangle::ray_triangle;
pub use e03_ray_sphere::ray_sphere;
pub use e04_shadow_ray::shadow_ray;
pub use e05_local_light::local_light;
pub use e06_reflected_ray::reflected_ray;
pub use e07_refracted_ray::refracted_ray;
pub use e08_lr::lr;
pub use e09_ray_tree::{count_rays, ray_tree};
pub use e10_samples::{pixel_mean, rms_error};

/// All of them.
pub const SUBJECT: Subject = Subject {
    primary_ray,
    ray_triangle,
    ray_sphere,
    shadow_ray,
    local_light,
    reflected_ray,
    refracted_ray,
    lr,
    ray_tree,
    count_rays,
    pixel_mean,
    rms_error,
};
