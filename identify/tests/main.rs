//! Logs of simulated arms, read and identified.

mod arms;
mod certificate;
mod codes;
mod coverage;
mod excite;
mod friction;
mod instruments;
mod options;
mod suspect;
mod text;
mod truth;
