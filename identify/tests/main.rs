//! Logs of simulated arms, read and identified.

mod arms;
mod baseline;
mod certificate;
mod codes;
mod coverage;
mod delays;
mod excite;
mod friction;
mod instruments;
mod options;
mod suspect;
mod text;
mod truth;
