//! lancer-figure
