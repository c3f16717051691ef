//! lancer-tests
