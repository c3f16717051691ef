//! Warps, their densities and the estimates made of them, against closed forms.

mod densities;
mod domain;
mod lamps;
mod lobes;
mod mis;
mod rows;
mod solid_angles;
mod spheres;
mod statistics;
mod strata;
