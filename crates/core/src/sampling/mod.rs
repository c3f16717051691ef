//! The samples of a pixel, their random numbers, and what becomes of these: directions, points of lamps, weights and
//! means. Everything follows from (seed, pixel, sample index) alone, so a picture does not depend on who renders
//! which pixel when.
//!
//! A sample's numbers come in sets of four ([`Sample::numbers`]), each set a scrambled Sobol sequence of its own:
//! what belongs together must share one, since only within a set are many samples stratified together.
//!
//! | set    | numbers 0 and 1                                                | numbers 2 and 3            |
//! |--------|----------------------------------------------------------------|----------------------------|
//! | 0      | the film point in its pixel, by [`Pattern::Owen`]; further on the direction of the ray that led here | the point on the first lamp |
//! | 1      | which way the ray goes on, and whether                         | which light is asked       |
//! | 2      | the point of the lens                                          | the time, –                |
//! | 3 …    | the point on the next lamp                                     | that on the one after      |
//!
//! The table is that of one surface: further on along a ray, a sample has sets of its own ([`Sample::along`]). A method
//! that needs more takes the next free sets and adds its rows here.
//!
//! A *warp* turns two numbers of [0, 1) into a point or a direction, and has a density: an estimate divides by it what
//! it finds there. Warps are continuous wherever they can be and keep areas in proportion, so that what is stratified
//! in the square is stratified on the lamp.

mod directions;
mod estimate;
mod keys;
mod mis;
mod patch;
mod pixel;
mod sobol;
mod solid_angle;
mod surfaces;
mod uniform;

pub use directions::{
    concentric_disc, cosine_hemisphere, cosine_hemisphere_density, phong_lobe, phong_lobe_density,
};
pub use estimate::Estimate;
pub use mis::power_heuristic;
pub use patch::{LampSample, Patch, SeenPatch};
pub use pixel::{Pattern, PixelSampling, Sample};
pub use solid_angle::{
    Rectangle, SeenSphere, SphericalRectangle, parallelogram_solid_angle, triangle_solid_angle,
};
pub use surfaces::{area_light_density, parallelogram, triangle};
pub use uniform::Uniform;
