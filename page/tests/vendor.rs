//! Third-party files match the table, and the table names all of them.

use std::path::Path;

use sha2::{Digest, Sha256};

#[test]
fn files_taken_in_are_unmodified() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("vendor");
    let table = std::fs::read_to_string(folder.join("SHA256SUMS")).expect("the table");
    let mut named: Vec<&str> = Vec::new();
    for line in table.lines() {
        let (hash, name) = line.split_once("  ").expect("a hash and a name");
        let digest = Sha256::digest(std::fs::read(folder.join(name)).expect("a file of the table"));
        let found: String = digest.iter().map(|byte| format!("{byte:02x}")).collect();
        assert_eq!(found, hash, "{name}");
        named.push(name);
    }
    for entry in std::fs::read_dir(&folder).expect("the folder").map(|entry| entry.expect("an entry").path()) {
        for file in entry.read_dir().into_iter().flatten().map(|file| file.expect("a file").path()) {
            let name = file.strip_prefix(&folder).expect("inside").to_string_lossy().into_owned();
            assert!(named.contains(&name.as_str()), "{name} is not in the table");
        }
    }
}
