//! What is executed against what is compiled.

mod bits;
