//! What every chapter needs to show a picture and to judge it: the room where `core` meets `figure` and
//! `exercise`.
//!
//! | here                     | what a chapter takes from it                                             |
//! |--------------------------|--------------------------------------------------------------------------|
//! | [`chapter`]              | the type of a chapter's one value: its figures, exercises, scenes, walks |
//! | [`picture`]              | pictures of scenes, and how they come onto a plate                        |
//! | [`judge`]                | errors by name and as tiles, means, growth exponents                      |
//! | [`scenes`]               | scenes by name, and those written in the code                             |
//! | [`view`]                 | a scene's outlines, rays and directions in a plane drawing                |
//! | [`naive`], [`hard_boxes`] | what textbooks get wrong, and the boxes that show it                      |
//!
//! This crate knows no crate of renderers or indexes.

pub mod chapter;
pub mod hard_boxes;
pub mod judge;
pub mod naive;
pub mod picture;
pub mod scenes;
pub mod view;

pub use chapter::Chapter;
