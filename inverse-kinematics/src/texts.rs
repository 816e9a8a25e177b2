//! The blocks as text, for a generator that prints them into a module.

/// A block's text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Text {
    /// The name of its file, without the ending.
    pub name: &'static str,
    /// What it says: items over `Real`, with outer attributes and documentation only.
    pub source: &'static str,
    /// The names of the texts whose items it uses; theirs are needed as well.
    pub needs: &'static [&'static str],
}

macro_rules! texts {
    ($($name:literal needs [$($need:literal),*],)*) => {
        /// Every text, each after those that it needs.
        pub const TEXTS: &[Text] = &[$(Text {
            name: $name,
            source: include_str!(concat!("blocks/", $name, ".rs")),
            needs: &[$($need),*],
        }),*];
    };
}

texts! {
    "scalar_f64" needs [],
    "scalar_f32" needs [],
    "frame" needs [],
    "angles" needs [],
    "line_and_circle" needs ["frame"],
    "turn" needs ["frame"],
    "two_turns" needs ["frame", "line_and_circle", "turn"],
    "two_links" needs ["frame"],
    "three_turns" needs ["frame"],
    "circle_roots" needs ["frame"],
    "branches" needs ["line_and_circle"],
    "regional" needs ["frame", "line_and_circle", "turn", "two_links", "circle_roots", "branches"],
    "regional_one_prismatic" needs ["regional"],
    "regional_prismatic" needs ["regional"],
    "parallel_axes" needs ["regional"],
    "spherical_triple" needs ["frame", "three_turns", "branches"],
    "parallel_turns" needs ["frame", "branches"],
    "three_prismatic" needs ["frame", "three_turns", "branches"],
    "closure" needs ["frame", "branches"],
    "samples" needs [],
    "spread" needs ["samples"],
    "eliminants" needs ["frame"],
    "determinant" needs ["closure", "circle_roots", "branches", "samples", "spread", "eliminants"],
    "two_slides" needs ["closure", "circle_roots", "branches", "samples"],
    "arrangement" needs ["frame", "branches"],
    "general" needs ["determinant", "arrangement"],
    "given" needs ["frame", "branches"],
    "shoulder_elbow_wrist" needs ["frame", "turn", "two_links", "regional", "three_turns", "branches", "arrangement"],
    "virtual_joints" needs ["closure", "arrangement"],
    "postures" needs ["frame", "angles", "branches"],
    "coordinates" needs ["postures"],
    "solutions" needs ["postures"],
}
