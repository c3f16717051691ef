//! lancer-core
