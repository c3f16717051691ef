//! lancer-whitted
