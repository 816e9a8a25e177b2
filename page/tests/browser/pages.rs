//! Descriptions and their pages: each page is written once for all tests.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use armgen_codegen::source::Source;
use armgen_page::Run;

use super::driver::{self, Tab};

/// All descriptions of the project, sorted.
pub(crate) fn robots() -> Vec<Source> {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    let folders = ["robots", "tests/robots"].map(|folder| format!("{root}/{folder}"));
    let entries = folders.iter().flat_map(|folder| std::fs::read_dir(folder).expect("a folder of robots"));
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "yaml"));
    paths.sort();
    let source = |path: PathBuf| {
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        Source::new(name, std::fs::read_to_string(path).expect("a description"))
    };
    paths.into_iter().map(source).collect()
}

/// A robot description by name.
pub(crate) fn robot(name: &str) -> Source {
    robots().into_iter().find(|source| source.name() == format!("{name}.yaml")).expect("a robot of the project")
}

/// An arm with this number of joints, the first prismatic.
pub(crate) fn long(joints: usize) -> Source {
    let mut text = String::from("name: long\nconvention: modified\ngravity: [0, 0, -9.81]\njoints:\n");
    for i in 0..joints {
        let kind = if i == 0 { "prismatic" } else { "revolute" };
        let alpha = ["pi/2", "-pi/2"][i % 2];
        text += &format!(
            "  - {{name: j{i}, type: {kind}, a: 0.{}, alpha: {alpha}, d: 0.{}, theta: 0, limits: {{position: [0.2, 1]}}, \
             link: {{mass: {}, com: [0.1, 0.02, 0.03], inertia: {{xx: 0.3, yy: 0.35, zz: 0.32}}}}}}\n",
            i + 11,
            i + 21,
            i + 2
        );
    }
    Source::new(format!("long{joints}.yaml"), text)
}

/// The page file of an arm.
pub(crate) fn written(source: &Source) -> PathBuf {
    type Pages = BTreeMap<[String; 2], (usize, Arc<OnceLock<PathBuf>>)>;
    static PAGES: Mutex<Pages> = Mutex::new(BTreeMap::new());
    let mut pages = PAGES.lock().unwrap_or_else(PoisonError::into_inner);
    let next = pages.len();
    let (number, page) =
        pages.entry([source.name().to_owned(), source.text().to_owned()]).or_insert_with(|| (next, Arc::default()));
    let (number, page) = (*number, Arc::clone(page));
    // Let other threads write their pages meanwhile.
    drop(pages);
    page.get_or_init(|| written_with(&format!("page-{number}"), source, &[])).clone()
}

/// Writes the page of an arm with runs into a folder.
pub(crate) fn written_with(folder: &str, source: &Source, runs: &[Run]) -> PathBuf {
    let file = driver::folder(folder).join(Path::new(source.name()).with_extension("html"));
    let (page, diagnostics) = armgen_page::page(source, runs).expect("the joints are those of the arm");
    std::fs::write(&file, page.unwrap_or_else(|| panic!("{diagnostics:?}"))).expect("the page is written");
    file
}

/// Opens the page of an arm with a window width and a theme; `None` without a browser.
#[track_caller]
pub(crate) fn opened(source: &Source, width: u32, theme: &str) -> Option<Tab> {
    driver::program()?;
    Tab::open(&written(source), width, theme)
}
