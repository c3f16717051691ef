//! chapter-1
