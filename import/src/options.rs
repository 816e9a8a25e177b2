//! The choices of an import.

use armgen_codegen::description::Convention;

/// The choices of an import.
#[derive(Clone, Debug)]
pub struct Options {
    /// The link that does not move; the root of the file if `None`.
    pub base: Option<String>,
    /// The link whose frame is the end effector's; the only one that it can be if `None`.
    pub tip: Option<String>,
    /// Links whose frames are those of several end effectors, each with the name of the end effector; the link's if `None`. None for an arm
    /// with one end effector, that of `tip`.
    pub tips: Vec<(Option<String>, String)>,
    /// Whether every joint below the base belongs to the arm, and each link that ends a branch carries an end effector.
    pub all: bool,
    /// Joints that stand still, each with an expression: `("finger", "0.04")`.
    pub lock: Vec<(String, String)>,
    /// The name of the robot; the file's if `None`.
    pub name: Option<String>,
    /// Angles within so many rad of a multiple of pi/12 are that multiple; 0: every digit is taken.
    pub snap: f64,
    /// Links without a mass distribution have mass 0.
    pub massless: bool,
    /// Tensors that no body has are taken as written, with a warning, and the description allows them.
    pub inertia_as_written: bool,
    /// The convention of the rows of the description. A file has rows of `Urdf`, and the others are computed from them.
    pub convention: Convention,
}

impl Options {
    /// The tolerance that [`Options::default`] has: four decimals of every multiple of pi/12 up to 2 pi are nearer.
    pub const SNAP: f64 = 2e-5;
    /// The largest tolerance.
    pub const LARGEST_SNAP: f64 = 1e-2;
}

impl Default for Options {
    fn default() -> Options {
        Options {
            base: None,
            tip: None,
            tips: Vec::new(),
            all: false,
            lock: Vec::new(),
            name: None,
            snap: Options::SNAP,
            massless: false,
            inertia_as_written: false,
            convention: Convention::Urdf,
        }
    }
}
