//! What only holds between chapters; see `suite/`.
