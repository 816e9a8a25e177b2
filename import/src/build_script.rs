//! The face for a build script: a URDF or a MuJoCo model instead of a description.
//!
//! ```no_run
//! // build.rs
//! use armgen_import::build_script::Robot;
//!
//! Robot::new("robot.urdf").tip("tool0").lock("finger_joint", "0.04").imported().generate();
//! ```
//!
//! The script reruns when the file changes. A file that cannot be imported fails the build with every fault and its place; warnings become
//! warnings of the build.

use std::path::{Path, PathBuf};

use armgen_codegen::build_script;
use armgen_codegen::diagnostic::{Colour, Diagnostics};
use armgen_codegen::source::Source;

use crate::{import, included, Options};

/// The arm of a file, with the options of [`Options`].
#[derive(Clone, Debug)]
pub struct Robot {
    path: PathBuf,
    options: Options,
}

impl Robot {
    /// The arm of the file in `path`, relative to the folder of the crate that is built.
    pub fn new(path: impl AsRef<Path>) -> Robot {
        Robot { path: path.as_ref().to_owned(), options: Options::default() }
    }

    /// The link that does not move; the root of the file if not said.
    #[must_use]
    pub fn base(mut self, link: impl Into<String>) -> Robot {
        self.options.base = Some(link.into());
        self
    }

    /// The link whose frame is the end effector's; the only one that it can be if not said.
    #[must_use]
    pub fn tip(mut self, link: impl Into<String>) -> Robot {
        self.options.tip = Some(link.into());
        self
    }

    /// One of several end effectors: its name, and the link whose frame is its.
    #[must_use]
    pub fn named_tip(mut self, name: impl Into<String>, link: impl Into<String>) -> Robot {
        self.options.tips.push((Some(name.into()), link.into()));
        self
    }

    /// Every joint below the base, and an end effector on each link that ends a branch.
    #[must_use]
    pub fn all(mut self) -> Robot {
        self.options.all = true;
        self
    }

    /// A joint that stands still, and where: an expression such as `0.04` or `pi/4`.
    #[must_use]
    pub fn lock(mut self, joint: impl Into<String>, value: impl Into<String>) -> Robot {
        self.options.lock.push((joint.into(), value.into()));
        self
    }

    /// The name of the robot; the file's if not said.
    #[must_use]
    pub fn name(mut self, name: impl Into<String>) -> Robot {
        self.options.name = Some(name.into());
        self
    }

    /// Angles within so many rad of a multiple of pi/12 are that multiple; 0 takes every digit.
    #[must_use]
    pub fn snap(mut self, tolerance: f64) -> Robot {
        self.options.snap = tolerance.clamp(0.0, Options::LARGEST_SNAP);
        self
    }

    /// Links without a mass distribution have mass 0.
    #[must_use]
    pub fn massless(mut self) -> Robot {
        self.options.massless = true;
        self
    }

    /// Tensors that no body has are taken as written, with a warning.
    #[must_use]
    pub fn inertia_as_written(mut self) -> Robot {
        self.options.inertia_as_written = true;
        self
    }

    /// Imports the file and gives what generates its module: the description is written into `OUT_DIR` under the name of the file. Ends the
    /// build with the reason if that cannot be.
    pub fn imported(&self) -> build_script::Robot {
        let description = self.try_description().unwrap_or_else(|error| {
            eprintln!("{error}");
            std::process::exit(1);
        });
        build_script::Robot::new(description)
    }

    /// Imports the file and gives the path of the description, which is written into `OUT_DIR`; for a build script that goes on.
    ///
    /// # Errors
    /// Why there is no description: every fault of the file with its place, or the file that cannot be read or written.
    pub fn try_description(&self) -> Result<PathBuf, String> {
        let name = self.path.display();
        println!("cargo:rerun-if-changed={name}");
        let text = std::fs::read_to_string(&self.path).map_err(|e| format!("error: cannot read {name}: {e}"))?;
        let source = Source::new(name.to_string(), text);
        let folder = self.path.parent().unwrap_or(Path::new(""));
        let read = |file: &str| {
            println!("cargo:rerun-if-changed={}", folder.join(file).display());
            beside(folder, file)
        };
        let source = included(&source, &read).map_err(|fault| {
            let mut faults = Diagnostics::new();
            faults.push(*fault);
            faults.render(&source, Colour::Never)
        })?;
        let (imported, diagnostics) = import(&source, &self.options);
        let imported = imported.ok_or_else(|| diagnostics.render(&source, Colour::Never))?;
        for warning in diagnostics.iter() {
            let place = source.place(warning.span().start);
            println!("cargo:warning={name}:{}:{}: {}", place.line, place.column, warning.message);
        }
        let out = std::env::var_os("OUT_DIR").map(PathBuf::from).ok_or("error: OUT_DIR is not set: this is for build scripts")?;
        let file = out.join(self.path.file_stem().unwrap_or("robot".as_ref())).with_extension("yaml");
        std::fs::write(&file, imported.yaml).map_err(|e| format!("error: cannot write {}: {e}", file.display()))?;
        Ok(file)
    }
}

/// The text of a file below a folder, by its relative path; why it cannot be had if not. A link that leads out of the folder is not followed.
///
/// # Errors
/// Why the file cannot be read.
pub fn beside(folder: &Path, file: &str) -> Result<String, String> {
    let words = |error: std::io::Error| error.to_string();
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let (folder, path) = (folder.canonicalize().map_err(words)?, folder.join(file).canonicalize().map_err(words)?);
    if !path.starts_with(folder) {
        return Err("it is outside of the model's folder".to_owned());
    }
    if std::fs::metadata(&path).map_err(words)?.len() > MAX_BYTES {
        return Err(format!("it is longer than {} MiB", MAX_BYTES >> 20));
    }
    std::fs::read_to_string(path).map_err(words)
}

/// Bytes of a file that a model includes.
const MAX_BYTES: u64 = 16 << 20;
