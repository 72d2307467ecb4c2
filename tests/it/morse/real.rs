//! The program that dumps pairs, and its use with real fields, is `tools/examples/extremum_pairs.rs`.
