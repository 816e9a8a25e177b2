//! Interface for build scripts: from a description in the crate to Rust in `OUT_DIR`.
//!
//! ```no_run
//! // build.rs
//! armgen_codegen::build_script::Robot::new("robot.yaml").generate();
//! ```
//!
//! writes `$OUT_DIR/robot.rs`, the module, and `$OUT_DIR/robot_runtime.rs`, the implementation of the runtime's traits. A crate takes them in by
//!
//! ```ignore
//! include!(concat!(env!("OUT_DIR"), "/robot.rs"));
//! ```
//!
//! The script reruns when the description changes (or the script itself) and only then. A wrong description fails the build with every
//! fault and its place; warnings of the description become warnings of the build.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

use crate::diagnostic::{Colour, Diagnostics};
pub use crate::kinds::Scalar;
pub use crate::pass::Pass;
pub use crate::program::Trig;

use crate::catalogue::Absent;
use crate::schedule::{Options, Selection, UnknownFunctions};
use crate::source::Source;

/// Why nothing was generated.
#[derive(Debug)]
#[non_exhaustive]
pub enum BuildError {
    /// The description cannot be read, or is not UTF-8.
    Read(PathBuf, io::Error),
    /// The description is faulty: every fault with its place.
    Description(Source, Diagnostics),
    /// A name that no function has.
    Functions(UnknownFunctions),
    /// A name in `allow` that is no kind of warning, and the suggested name.
    Warning(String, String),
    /// A requested function that this arm lacks.
    Absent(PathBuf, Absent),
    /// `OUT_DIR` is not set: this is no build script.
    NoOutDir,
    /// A file cannot be written.
    Write(PathBuf, io::Error),
}

impl fmt::Display for BuildError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            BuildError::Read(path, error) => write!(f, "error: cannot read {}: {error}", path.display()),
            BuildError::Description(source, diagnostics) => f.write_str(&diagnostics.render(source, Colour::Never)),
            BuildError::Functions(unknown) => write!(f, "error: {unknown}"),
            BuildError::Warning(kind, help) => write!(f, "error: no kind of warning is called `{kind}`: {help}"),
            BuildError::Absent(path, Absent { function, reason }) => {
                write!(f, "error: {} has no `{function}`: {reason}", path.display())
            }
            BuildError::NoOutDir => f.write_str("error: OUT_DIR is not set: this is for build scripts"),
            BuildError::Write(path, error) => write!(f, "error: cannot write {}: {error}", path.display()),
        }
    }
}

impl std::error::Error for BuildError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            BuildError::Read(_, error) | BuildError::Write(_, error) => Some(error),
            BuildError::Functions(unknown) => Some(unknown),
            BuildError::Description(..) | BuildError::Warning(..) | BuildError::Absent(..) | BuildError::NoOutDir => None,
        }
    }
}

/// A description to generate from.
#[derive(Clone, Debug)]
pub struct Robot {
    description: PathBuf,
    options: Options,
    functions: Vec<String>,
    stem: Option<String>,
    c_abi: bool,
    inverse_kinematics: bool,
    strict: bool,
    allow: Vec<String>,
}

impl Robot {
    /// The description in `path`, relative to the folder of the crate that is built.
    pub fn new(path: impl AsRef<Path>) -> Robot {
        Robot {
            description: path.as_ref().to_path_buf(),
            options: Options::default(),
            functions: Vec::new(),
            stem: None,
            c_abi: false,
            inverse_kinematics: false,
            strict: false,
            allow: Vec::new(),
        }
    }

    /// The scalar type of `Real`; f64 unless chosen.
    #[must_use]
    pub fn scalar(mut self, scalar: Scalar) -> Robot {
        self.options.scalar = scalar;
        self
    }

    /// Where the sines and cosines of the module come from; the crate `libm` unless chosen.
    #[must_use]
    pub fn trig(mut self, trig: Trig) -> Robot {
        self.options.trig = trig;
        self
    }

    /// Leaves a pass out, of those that make the functions cheaper; may be called for several.
    #[must_use]
    pub fn without(mut self, pass: Pass) -> Robot {
        self.options.without.insert(pass);
        self
    }

    /// Adds the modules `lanes` and `batch`: functions for many states, in blocks of this size. 8 serve f64 on every present
    /// processor, 16 serve f32.
    #[must_use]
    pub fn batch(mut self, lanes: usize) -> Robot {
        self.options.batch = Some(lanes);
        self
    }

    /// Fuses a multiplication with an addition that is the only user of its product, as `Real::mul_add`, which rounds once. The
    /// module then needs `std` and a processor with the operation (`-C target-feature=+fma`, `-C target-cpu=native`). Without
    /// such a processor each becomes a much slower call.
    #[must_use]
    pub fn fused_multiply_add(mut self) -> Robot {
        self.options.fuse = true;
        self
    }

    /// The functions of the module by their names, for instance `["gravity", "inertia_matrix_with"]`; all by default. A name that
    /// no function has ends the build. The traits of the runtime are implemented only if all functions that they need are there.
    #[must_use]
    pub fn functions<S: Into<String>>(mut self, names: impl IntoIterator<Item = S>) -> Robot {
        self.functions = names.into_iter().map(Into::into).collect();
        self
    }

    /// The name of the written files without their ending, where it differs from the description's: for instance for the same
    /// robot in two scalars.
    #[must_use]
    pub fn file_stem(mut self, stem: impl Into<String>) -> Robot {
        self.stem = Some(stem.into());
        self
    }

    /// Also writes the interface for C: `robot.h`, and `robot_c.rs` to be included next to the module in a static or dynamic library.
    #[must_use]
    pub fn c_abi(mut self) -> Robot {
        self.c_abi = true;
        self
    }

    /// Also writes `robot_ik.rs`: all joint variables that reach a pose. Include it in a module `robot_ik`, next to the module that includes
    /// `robot.rs` and `robot_runtime.rs`. The implementation of the runtime's trait `InverseKinematics` uses this path. For an arm without a
    /// construction the file only holds a comment with the reason, and the trait is not implemented. Named end effectors have a file each,
    /// `robot_left_ik.rs` of `left`, and no trait.
    #[must_use]
    pub fn inverse_kinematics(mut self) -> Robot {
        self.inverse_kinematics = true;
        self
    }

    /// Ends the build on a warning of the description.
    #[must_use]
    pub fn strict(mut self) -> Robot {
        self.strict = true;
        self
    }

    /// Suppresses kinds of warnings by their names, for instance `["missing-inertia"]`, like `allow` in the description. A name
    /// that no warning has ends the build.
    #[must_use]
    pub fn allow<S: Into<String>>(mut self, kinds: impl IntoIterator<Item = S>) -> Robot {
        self.allow.extend(kinds.into_iter().map(Into::into));
        self
    }

    /// Writes the module and the trait implementation into `OUT_DIR`, named after the description's file, or ends the build with the reason.
    pub fn generate(&self) {
        if let Err(error) = self.try_generate() {
            eprintln!("{error}");
            std::process::exit(1);
        }
    }

    /// The same for a build script that goes on: the files that were written.
    ///
    /// # Errors
    /// Where the description cannot be read or is faulty, or a file cannot be written.
    pub fn try_generate(&self) -> Result<Vec<PathBuf>, BuildError> {
        let path = self.description.display();
        // One colon: cargo refuses two where the user's crate declares a Rust older than 1.77.
        println!("cargo:rerun-if-changed={path}");
        // Reading as a string refuses text that is not UTF-8.
        let text =
            std::fs::read_to_string(&self.description).map_err(|error| BuildError::Read(self.description.clone(), error))?;
        let source = Source::new(path.to_string(), text);
        let mut options = self.options.clone();
        if !self.functions.is_empty() {
            options.functions = Selection::named(&self.functions).map_err(BuildError::Functions)?;
        }
        for kind in &self.allow {
            crate::validate::warning(kind).map_err(|help| BuildError::Warning(kind.clone(), help))?;
        }
        let (generated, mut diagnostics) = crate::generate(&source, &options);
        diagnostics.allow(&self.allow);
        let Some(generated) = generated else { return Err(BuildError::Description(source, diagnostics)) };
        if let (false, Some(absent)) = (options.functions.is_all(), generated.absent.first()) {
            return Err(BuildError::Absent(self.description.clone(), absent.clone()));
        }
        if self.strict && !diagnostics.is_empty() {
            return Err(BuildError::Description(source, diagnostics));
        }
        for warning in diagnostics.iter() {
            let place = source.place(warning.span().range().start);
            println!("cargo:warning={path}:{}:{}: {}", place.line, place.column, warning.message);
        }
        let out = std::env::var_os("OUT_DIR").map(PathBuf::from).ok_or(BuildError::NoOutDir)?;
        let own = || self.description.file_stem().map_or("robot".into(), |s| s.to_string_lossy().into_owned());
        let stem = self.stem.clone().unwrap_or_else(own);
        let ik = crate::validate::module_name(&format!("{stem}_ik"));
        let mut others = Vec::new();
        let mut runtime = generated.runtime.clone();
        if self.inverse_kinematics {
            runtime = generated.runtime_with_inverse_kinematics(&ik);
            for solver in generated.solvers() {
                let stem = format!("{stem}{}_ik", solver.infix());
                others.push((format!("{stem}.rs"), solver.text()));
                if let (true, Some(face)) = (self.c_abi, solver.for_c()) {
                    others.extend([(format!("{stem}.h"), face.header), (format!("{stem}_c.rs"), face.wrappers)]);
                }
            }
        }
        if let Some(face) = self.c_abi.then(|| generated.laws_for_c(&format!("{stem}.h"))).flatten() {
            others.extend([(format!("{stem}_laws.h"), face.header), (format!("{stem}_laws_c.rs"), face.wrappers)]);
        }
        let mut files = vec![(format!("{stem}.rs"), generated.module), (format!("{stem}_runtime.rs"), runtime)];
        if self.c_abi {
            files.extend([(format!("{stem}.h"), generated.c.header), (format!("{stem}_c.rs"), generated.c.wrappers)]);
        }
        files.extend(others);
        let mut written = Vec::new();
        for (name, text) in files {
            let file = out.join(name);
            std::fs::write(&file, text).map_err(|error| BuildError::Write(file.clone(), error))?;
            written.push(file);
        }
        Ok(written)
    }
}
