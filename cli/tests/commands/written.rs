//! Files that are written: the same bytes everywhere, and none over another.

use std::fs;
use std::path::{Path, PathBuf};

use super::{check, err, file, folder, out};

#[test]
fn generate_writes_the_same_bytes_everywhere() {
    let printed = check(&["generate", &file("robots/scara.yaml")], 0).stdout;
    let folder = folder("generate");
    let path = folder.join("robot.rs");
    let path = path.to_str().expect("UTF-8");
    let output = check(&["generate", &file("robots/scara.yaml"), "--out", path], 0);
    assert!(output.stdout.is_empty());
    assert_eq!(fs::read(path).expect("the file is written"), printed);
    assert!(String::from_utf8(printed).expect("UTF-8").contains("pub type Real = f64;"));
    let single = out(&check(&["generate", &file("robots/scara.yaml"), "--scalar", "f32"], 0));
    assert!(single.contains("pub type Real = f32;"));
    let fast = out(&check(&["generate", &file("robots/panda7.yaml"), "--trig", "fast"], 0));
    assert!(fast.contains("sin_cos_eight(") && fast.contains("fn sin_cos_beyond("), "{fast}");
    let standard = out(&check(&["generate", &file("robots/scara.yaml"), "--trig", "std"], 0));
    assert!(standard.contains("x.sin_cos()") && !standard.contains("libm::"), "{standard}");
    check(&["generate", &file("robots/scara.yaml"), "--out", folder.to_str().expect("UTF-8")], 2);
}

/// A description in a folder, under a name, and its text.
fn copied(folder: &Path, name: &str) -> (PathBuf, Vec<u8>) {
    let description = folder.join(name);
    fs::copy(file("robots/scara4.yaml"), &description).expect("a copy");
    let text = fs::read(&description).expect("the copy");
    (description, text)
}

#[test]
fn generate_does_not_overwrite_its_description() {
    let folder = folder("overwrite");
    let (description, before) = copied(&folder, "robot.yaml");
    let other_name = folder.join("..").join("overwrite").join("robot.yaml");
    for out in [&description, &other_name] {
        let arguments = ["generate", description.to_str().expect("UTF-8"), "--out", out.to_str().expect("UTF-8")];
        let output = check(&arguments, 2);
        assert!(err(&output).contains("is the description"), "{}", err(&output));
        assert_eq!(fs::read(&description).expect("still there"), before);
    }
    let names: Vec<_> = fs::read_dir(&folder).expect("a folder").map(|e| e.expect("an entry").file_name()).collect();
    assert_eq!(names, ["robot.yaml"], "nothing half written is left");
}

#[test]
fn a_page_does_not_overwrite_its_logs() {
    let folder = folder("page_logs");
    let path = |name: &str| folder.join(name).to_str().expect("UTF-8").to_owned();
    fs::create_dir_all(path("r1")).expect("a folder");
    fs::create_dir_all(path("r2")).expect("a folder");
    let text = "t,w\n0,1\n1,2\n";
    for log in ["r1/a.csv", "r2/a.csv"] {
        fs::write(path(log), text).expect("a file");
    }
    let robot = file("tests/robots/single_joint.yaml");
    let page = |out: &str, logs: [&str; 2], code| {
        check(&["page", &robot, "--out", &path(out), "--log", &path(logs[0]), "--log", &path(logs[1])], code)
    };
    let output = page("r2/../r1/a.csv", ["r1/a.csv", "r2/a.csv"], 2);
    assert!(err(&output).contains("is a log of the page: it would be overwritten"), "{}", err(&output));
    assert_eq!(fs::read_to_string(path("r1/a.csv")).expect("still there"), text);
    // Logs of one name are called by their folders as well.
    page("page.html", ["r1/a.csv", "r2/a.csv"], 0);
    let html = fs::read_to_string(path("page.html")).expect("the page");
    assert!(html.contains("data-log=\"r1/a\"") && html.contains("data-log=\"r2/a\""));
    let output = page("page.html", ["r1/a.csv", "r1/../r1/a.csv"], 1);
    assert!(err(&output).contains("the log is named twice"), "{}", err(&output));
    fs::write(path("r1/a.csv"), "t,w\n").expect("a file");
    let output = page("page.html", ["r1/a.csv", "r2/a.csv"], 1);
    assert!(err(&output).contains("a.csv: the log has no samples"), "{}", err(&output));
}

#[test]
fn no_file_beside_the_module_is_written_over_another() {
    let folder = folder("beside");
    let (description, before) = copied(&folder, "arm.h");
    for (out, complaint) in [("module.h", "is a file of C"), ("arm.rs", "two of the files to write would both be")] {
        let out = folder.join(out);
        let paths = [&description, &out].map(|path| path.to_str().expect("UTF-8"));
        let output = check(&["generate", paths[0], "--out", paths[1], "--c-abi"], 2);
        assert!(err(&output).contains(complaint), "{}", err(&output));
        assert!(!out.exists());
        assert_eq!(fs::read(&description).expect("still there"), before);
    }
}

#[test]
fn a_companion_finds_its_module_whatever_the_file_is_called() {
    let folder = folder("companion");
    for (stem, module) in
        [("arm", "arm"), ("my-robot", "my_robot"), ("2r", "_2r"), ("fn", "_fn"), ("gen", "_gen"), ("arm\u{b2}.v1", "arm__v1")]
    {
        let out = folder.join(format!("{stem}.rs"));
        let description = file("tests/robots/single_joint.yaml");
        check(&["generate", &description, "--out", out.to_str().expect("UTF-8"), "--bounds"], 0);
        let companion = fs::read_to_string(folder.join(format!("{stem}_bounds.rs"))).expect("the companion");
        assert!(companion.contains(&format!("\nuse super::{module}::*;\n")), "{stem}");
    }
}

/// The text is put together in a file that was not there before.
#[test]
fn a_file_with_the_name_of_one_that_is_written_stays() {
    let folder = folder("new");
    let (description, before) = copied(&folder, "foo.new");
    let (other, out) = (folder.join("foo.new1"), folder.join("foo"));
    fs::write(&other, "other").expect("a file");
    let paths = [&description, &out].map(|path| path.to_str().expect("UTF-8"));
    check(&["export", paths[0], "--format", "urdf", "--out", paths[1]], 0);
    assert!(fs::read_to_string(&out).expect("it is written").contains("<robot "));
    assert_eq!(fs::read(&description).expect("still there"), before);
    assert_eq!(fs::read(&other).expect("still there"), b"other");
    let names = || {
        let mut names: Vec<_> = fs::read_dir(&folder).expect("a folder").map(|e| e.expect("an entry").file_name()).collect();
        names.sort();
        names
    };
    assert_eq!(names(), ["foo", "foo.new", "foo.new1"], "nothing half written is left");
}

#[test]
fn one_file_is_not_written_twice_whatever_it_is_called() {
    let folder = folder("twice");
    let urdf = file("import/tests/urdf/everything.urdf");
    let paths = ["a.yaml", "./a.yaml", "../twice/a.yaml", "made/a.yaml", "made/./a.yaml"].map(|path| folder.join(path));
    let paths = paths.each_ref().map(|path| path.to_str().expect("UTF-8"));
    for (out, report) in [(0, 1), (0, 2), (2, 1), (3, 4)] {
        let chain = ["import", &urdf, "--base", "base", "--tip", "tip", "--lock", "finger=0.04"];
        let output = check(&[&chain[..], &["--out", paths[out], "--report", paths[report]]].concat(), 2);
        assert!(err(&output).contains("--out and --report name one file"), "{}", err(&output));
        assert!(!Path::new(paths[out]).exists());
    }
}

/// A companion whose path links to the module would overwrite the module.
#[cfg(unix)]
#[test]
fn a_companion_is_not_written_through_a_link_to_its_module() {
    let folder = folder("linked");
    let (module, companion) = (folder.join("arm.rs"), folder.join("arm_bounds.rs"));
    fs::write(&module, "").expect("a file");
    std::os::unix::fs::symlink(&module, &companion).expect("a link");
    let description = file("tests/robots/single_joint.yaml");
    let output = check(&["generate", &description, "--out", module.to_str().expect("UTF-8"), "--bounds"], 2);
    assert!(err(&output).contains("two of the files to write would both be"), "{}", err(&output));
    assert_eq!(fs::read(&module).expect("still there"), b"");
}

/// Valid numbers whose product no float holds.
#[test]
fn products_out_of_range_are_told_before_anything_is_printed() {
    let text = fs::read_to_string(file("tests/robots/single_joint.yaml")).expect("a description");
    let folder = folder("out_of_range");
    for (size, scalar) in [("1e200", "f64"), ("1e30", "f32")] {
        let path = folder.join(format!("{scalar}.yaml"));
        let changed = text.replace("a: 0.6", &format!("a: {size}")).replace("mass: 1.2", &format!("mass: {size}"));
        assert!(changed.contains(&format!("mass: {size}")) && changed.contains(&format!("a: {size}")), "{changed}");
        fs::write(&path, changed).expect("a file");
        let path = path.to_str().expect("UTF-8");
        let output = check(&["generate", path, "--scalar", scalar], 1);
        assert!(out(&output).is_empty() && err(&output).contains("error["), "{}", err(&output));
        if scalar == "f64" {
            check(&["check", path], 1);
        }
    }
}

/// With `--check` nothing is written, and each file that is missing, stale or edited is named.
#[test]
fn generate_compares_files_with_what_it_would_write() {
    let folder = folder("compared");
    let (description, text) = copied(&folder, "robot.yaml");
    let (yaml, module) = (description.to_str().expect("UTF-8"), folder.join("robot.mjs"));
    let generate = |more: &[&str], code| {
        let fixed = ["generate", yaml, "--language", "javascript", "--out", module.to_str().expect("UTF-8")];
        err(&check(&[&fixed[..], more].concat(), code))
    };
    let said = generate(&["--check"], 1);
    assert!(said.contains("robot.mjs is missing") && said.contains("robot.d.mts is missing"), "{said}");
    assert!(!module.exists(), "nothing is written");
    generate(&[], 0);
    assert!(generate(&["--check"], 0).contains("2 files as the description gives them"));
    let right = fs::read_to_string(&module).expect("the module");
    let edited = format!("{right}\n");
    fs::write(&module, &edited).expect("a file");
    let said = generate(&["--check"], 1);
    assert!(said.contains("robot.mjs was edited") && !said.contains("robot.d.mts"), "{said}");
    assert_eq!(fs::read_to_string(&module).expect("still there"), edited);
    fs::write(&module, right).expect("a file");
    fs::write(&description, [&text[..], b"\n"].concat()).expect("a description");
    let said = generate(&["--check"], 1);
    assert!(said.contains("robot.mjs is stale: it was made from another text of"), "{said}");
    let said = err(&check(&["verify", yaml, module.to_str().expect("UTF-8")], 1));
    let last = said.lines().last().unwrap_or_default();
    assert!(last.contains("robot.mjs is stale") && last.contains("--language javascript --out"), "{said}");
    assert_eq!(check(&["generate", yaml, "--check"], 2).stdout, b"");
}
