//! lancer-accel
