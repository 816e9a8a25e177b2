//! The files of a release name one version.

use std::fs;
use std::path::Path;

#[test]
fn files_of_a_release_name_one_version() {
    let version = env!("CARGO_PKG_VERSION");
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let read = |file: &str| fs::read_to_string(root.join(file)).expect(file);
    let exact = format!("armgen=={version}");
    assert!(read("action.yml").contains(&exact), "action.yml: the default of `package` is not {exact}");
    let hooks = read("pyproject.toml");
    assert!(hooks.contains(&exact) && hooks.contains(&format!("\nversion = \"{version}\"\n")), "pyproject.toml: not {version}");
    assert!(read("python/Cargo.toml").contains(&format!("\nversion = \"{version}\"\n")), "python/Cargo.toml: not {version}");
    let own = read("Cargo.toml");
    let crates: Vec<&str> = own.lines().filter(|line| line.starts_with("armgen-")).collect();
    assert!(crates.len() > 15, "{crates:?}");
    for line in crates {
        assert!(line.contains(&format!("version = \"{version}\"")), "{line}");
    }
}
