//! Projects of strangers: folders with files, outside of this workspace, built by cargo without network.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A folder that somebody else's project lives in.
#[derive(Clone, Debug)]
pub struct Project {
    folder: PathBuf,
    target: PathBuf,
}

/// The folder of this workspace.
pub fn workspace() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("tests/ lies in the workspace")
}

impl Project {
    /// An empty project in `root`; all projects of a root share what cargo builds for them.
    ///
    /// It starts from the versions that this workspace has chosen, so that they need not be looked up.
    pub fn new(root: &Path, name: &str) -> Project {
        let folder = root.join(name);
        if folder.exists() {
            std::fs::remove_dir_all(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
        }
        let project = Project { folder, target: root.join("target") };
        project.write("Cargo.lock", &read(&workspace().join("Cargo.lock")));
        project
    }

    /// The project's folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Writes a file, with the folders above it.
    pub fn write(&self, path: &str, text: &str) {
        let path = self.folder.join(path);
        std::fs::create_dir_all(path.parent().expect("a file lies in a folder")).expect("the folder can be made");
        std::fs::write(&path, text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    }

    /// Text of a file.
    pub fn read(&self, path: &str) -> String {
        read(&self.folder.join(path))
    }

    /// Runs cargo in the project, without network.
    pub fn cargo(&self, arguments: &[&str]) -> Output {
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let mut command = Command::new(cargo);
        command.args(arguments).arg("--offline").current_dir(&self.folder);
        // Variables that the running cargo has set for itself.
        for (name, _) in std::env::vars_os() {
            let text = name.to_string_lossy();
            if text.starts_with("CARGO_PKG_") || text.starts_with("CARGO_MANIFEST") {
                command.env_remove(&name);
            }
        }
        command.env("CARGO_TARGET_DIR", &self.target).env("CARGO_TERM_COLOR", "never").output().expect("cargo starts")
    }

    /// Runs cargo, which must succeed; returns the output of the program.
    #[track_caller]
    pub fn succeed(&self, arguments: &[&str]) -> String {
        let output = self.cargo(arguments);
        assert!(output.status.success(), "{arguments:?} in {}:\n{}", self.folder.display(), text(&output.stderr));
        text(&output.stdout)
    }

    /// Runs cargo, which must fail; returns its messages.
    #[track_caller]
    pub fn fail(&self, arguments: &[&str]) -> String {
        let output = self.cargo(arguments);
        assert!(!output.status.success(), "{arguments:?} succeeds in {}", self.folder.display());
        text(&output.stderr)
    }

    /// Builds, and gives the folder into which the build script of a package of this project wrote, now or before.
    #[track_caller]
    pub fn built(&self, arguments: &[&str]) -> PathBuf {
        let messages = self.succeed(&[&["build", "--message-format", "json"], arguments].concat());
        let own = self.folder.display().to_string();
        let written = |line: &str| -> Option<PathBuf> {
            let message: serde_json::Value = serde_json::from_str(line).ok()?;
            let here = message["package_id"].as_str()?.contains(&own) && message["reason"] == "build-script-executed";
            here.then(|| PathBuf::from(message["out_dir"].as_str().unwrap_or_default()))
        };
        messages.lines().find_map(written).unwrap_or_else(|| panic!("no build script in {own}:\n{messages}"))
    }
}

/// When a file was written.
pub fn modified(path: &Path) -> std::time::SystemTime {
    path.metadata().and_then(|m| m.modified()).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}
