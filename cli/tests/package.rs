//! `armgen generate --package`: the package and the project of docs/packages.md are built by CMake, and by ament if it is installed.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::installed;
use crate::languages::{check, folder};

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().expect("the repository exists")
}

/// The first block of a language on the page.
fn block(page: &str, language: &str) -> String {
    let (_, rest) = page.split_once(&format!("```{language}\n")).expect("a block");
    rest.split_once("```").expect("its end").0.to_owned()
}

/// Runs a program within a folder; its standard output.
#[track_caller]
fn run(folder: &Path, program: &str, arguments: &[&str]) -> String {
    let output = Command::new(program).current_dir(folder).args(arguments).output().expect("it runs");
    let [out, error] = [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
    assert!(output.status.success(), "{program} {arguments:?}\n{out}\n{error}");
    out
}

/// Writes the package of the page's command into a folder.
fn generate(folder: &PathBuf, page: &str) {
    let command = block(page, "sh").replace("\\\n", " ");
    let robot = root().join("robots/ur5.yaml");
    let arguments = shlex(command.trim().strip_prefix("armgen ").expect("a command"));
    let arguments: Vec<&str> = arguments
        .iter()
        .map(|argument| if argument == "robots/ur5.yaml" { robot.to_str().expect("UTF-8") } else { argument })
        .collect();
    let said = check(folder, &arguments, 0);
    assert_eq!(said, "", "no placeholder is left");
}

/// Words of a command line with quotation marks.
fn shlex(line: &str) -> Vec<String> {
    let quoted = |(i, part): (usize, &str)| match i % 2 {
        0 => part.split_whitespace().map(str::to_owned).collect(),
        _ => vec![part.to_owned()],
    };
    line.split('"').enumerate().flat_map(quoted).collect()
}

#[test]
fn the_files_of_a_package_name_it() {
    let folder = folder("package_files");
    let page = fs::read_to_string(root().join("docs/packages.md")).expect("the page");
    generate(&folder, &page);
    let package = folder.join("ur5_armgen");
    for line in page.lines().filter(|line| line.starts_with("| `")) {
        let files = line.split('|').nth(1).expect("a cell").split(", ").map(|file| file.trim().trim_matches('`'));
        files.for_each(|file| assert!(package.join(file).is_file(), "{file}"));
    }
    let manifest = fs::read_to_string(package.join("package.xml")).expect("package.xml");
    assert!(manifest.contains("<maintainer email=\"ada@example.org\">Ada Lovelace</maintainer>"), "{manifest}");
    let sketch = "examples/gravity/gravity.ino";
    for name in ["CMakeLists.txt", "package.xml", "README.md", "library.properties", "library.json", "src/ur5.h", sketch] {
        let text = fs::read_to_string(package.join(name)).expect("a file");
        let holes =
            ["@NAME@", "@ROBOT@", "@MADE@", "@VERSION@", "@TESTS@", "@CALL@", "@MAIL@", "@DESCRIPTION@", "@UPPER@", "@GIVEN@"];
        assert!(holes.iter().all(|hole| !text.contains(hole)), "{name}: {text}");
    }
}

/// Compiles the sketch SKETCH.ino with a file of the tests, as Arduino compiles it, without a warning.
/// Returns the output on this machine; under QEMU a Cortex-M4F prints the same. `None` without a compiler.
fn on_a_microcontroller(folder: &Path, program: &str) -> Option<String> {
    for (name, text) in [
        ("arduino.h", include_str!("arduino/arduino.h")),
        ("gravity.cpp", include_str!("arduino/gravity.cpp")),
        ("hobby.cpp", include_str!("arduino/hobby.cpp")),
        ("start.c", include_str!("arduino/start.c")),
        ("board.ld", include_str!("arduino/board.ld")),
    ] {
        fs::write(folder.join(name), text).expect("a file");
    }
    let options = format!("-std=gnu++11 -Wall -Wextra -Werror -I library/src -I library/examples/gravity {program}.cpp");
    let board = "-mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16 -O2";
    let compile = |compiler: &str, options: &str| run(folder, compiler, &options.split(' ').collect::<Vec<_>>());
    if !installed::there("g++", "g++") {
        return None;
    }
    if !installed::runs("sh", &["-c", "test -f \"$(arm-none-eabi-gcc -print-file-name=rdimon.specs)\""]) {
        installed::left_out("no compiler for microcontrollers here (Debian: gcc-arm-none-eabi, libnewlib-arm-none-eabi)");
        return None;
    }
    compile("g++", &format!("{options} -o host"));
    compile("arm-none-eabi-gcc", &format!("{board} -c start.c"));
    // The driver of C compiles C++ all the same, and links no library of C++.
    let links = "-fno-exceptions start.o --specs=rdimon.specs -T board.ld -lm -o board.elf";
    compile("arm-none-eabi-gcc", &format!("{board} {options} {links}"));
    let here = run(folder, &folder.join("host").display().to_string(), &[]);
    if installed::there("qemu-system-arm", "qemu-system-arm") {
        let qemu = "-M mps2-an386 -nographic -semihosting-config enable=on,target=native -kernel board.elf";
        assert_eq!(run(folder, "qemu-system-arm", &qemu.split(' ').collect::<Vec<_>>()), here);
    }
    Some(here)
}

/// The sketch of the package and a thousand states.
#[test]
#[ignore = "wide"]
fn the_library_of_arduino_has_the_same_bits_on_a_microcontroller() {
    let folder = folder("package_arduino");
    let robot = root().join("robots/ur5.yaml").display().to_string();
    check(&folder, &["generate", &robot, "--language", "c", "--package", "--scalar", "f32", "--out", "library"], 0);
    let manifest = fs::read_to_string(folder.join("library/library.json")).expect("library.json");
    let manifest: serde_json::Value = serde_json::from_str(&manifest).expect("JSON");
    assert_eq!((&manifest["license"], &manifest["headers"]), (&"set me".into(), &"ur5.h".into()));
    if let Some(said) = on_a_microcontroller(&folder, "gravity") {
        assert!(said.starts_with("0 -59.17"), "{said}");
    }
}

/// The commands of docs/hobby-arm.md, and its sketch.
#[test]
#[ignore = "wide"]
fn the_tutorial_of_a_hobby_arm_prints_its_duties() {
    let folder = folder("package_hobby");
    let page = include_str!("../../docs/hobby-arm.md");
    fs::create_dir_all(folder.join("robots")).expect("a folder");
    fs::copy(root().join("robots/so101.urdf"), folder.join("robots/so101.urdf")).expect("a copy");
    for commands in page.split("```sh\n").skip(1) {
        for command in commands.split("```").next().expect("a block").lines() {
            let arguments = shlex(command.strip_prefix("armgen ").expect("a command"));
            check(&folder, &arguments.iter().map(String::as_str).collect::<Vec<_>>(), 0);
        }
    }
    fs::rename(folder.join("so101_armgen"), folder.join("library")).expect("the library");
    fs::write(folder.join("hobby.ino"), block(page, "cpp")).expect("a file");
    if let Some(said) = on_a_microcontroller(&folder, "hobby") {
        assert_eq!(said, block(page, "text"));
    }
}

#[test]
fn files_of_others_stay_whole() {
    let folder = folder("package_of_others");
    let robot = root().join("robots/scara.yaml");
    let robot = robot.to_str().expect("UTF-8");
    let generate =
        |code| check(&folder, &["generate", robot, "--language", "c", "--package", "--functions", "gravity", "--out", "p"], code);
    let said = generate(0);
    assert!(said.contains("set me") && said.contains("--maintainer and --license"), "{said}");
    // What armgen has written may be written again.
    generate(0);
    for name in ["CMakeLists.txt", "package.xml", "README.md", "library.properties", "library.json", "src/scara.h"] {
        let file = folder.join("p").join(name);
        let text = fs::read_to_string(&file).expect("a file");
        fs::write(&file, "mine\n").expect("the file");
        assert!(generate(2).contains(&format!("{name} is not written by armgen")));
        assert_eq!(fs::read_to_string(&file).expect("a file"), "mine\n");
        fs::write(&file, text).expect("the file");
    }
    let said = check(&folder, &["generate", robot, "--package", "--out", "q"], 2);
    assert!(said.contains("--language c"), "{said}");
}

#[test]
#[ignore = "wide"]
fn cmake_and_ament_build_the_package_and_a_project_with_it() {
    if !installed::there("cmake", "cmake") {
        return;
    }
    let folder = folder("package_built");
    let page = fs::read_to_string(root().join("docs/packages.md")).expect("the page");
    generate(&folder, &page);
    fs::write(folder.join("main.c"), block(&page, "c")).expect("main.c");
    let lists = block(&page, "cmake");
    let project = |lists: &str, build: &str, arguments: &[&str]| {
        fs::write(folder.join("CMakeLists.txt"), lists).expect("CMakeLists.txt");
        run(&folder, "cmake", &[&["-S", ".", "-B", build], arguments].concat());
        run(&folder, "cmake", &["--build", build]);
        assert_eq!(
            run(&folder, &folder.join(build).join("controller").display().to_string(), &[]),
            block(&page, "text"),
            "{build}"
        );
    };
    project(&lists, "by_sources", &[]);
    // C++ of two standards takes the same header.
    fs::copy(folder.join("main.c"), folder.join("main.cpp")).expect("main.cpp");
    for standard in ["11", "20"] {
        let lists = lists.replace("LANGUAGES C", "LANGUAGES C CXX").replace("main.c", "main.cpp");
        project(&lists, &format!("cpp{standard}"), &[&format!("-DCMAKE_CXX_STANDARD={standard}")]);
    }
    let installed = lists.replace("add_subdirectory(ur5_armgen)", "find_package(ur5_armgen 0.1 REQUIRED)");
    let package = |name: &str, argument: &str| {
        let [build, prefix] = ["build", "prefix"].map(|part| folder.join(format!("{name}_{part}")).display().to_string());
        let to = format!("-DCMAKE_INSTALL_PREFIX={prefix}");
        run(&folder, "cmake", &["-S", "ur5_armgen", "-B", &build, &to, argument]);
        run(&folder, "cmake", &["--build", &build]);
        let tests = run(Path::new(&build), "ctest", &[]);
        assert!(tests.contains("100% tests passed, 0 tests failed out of 2"), "{tests}");
        run(&folder, "cmake", &["--install", &build]);
        project(&installed, &format!("by_{name}"), &[&format!("-DCMAKE_PREFIX_PATH={prefix}"), argument]);
        PathBuf::from(prefix)
    };
    package("cmake", "-DCMAKE_DISABLE_FIND_PACKAGE_ament_cmake=ON");
    // Debian's packages of ament are for its own Python.
    if !Path::new("/usr/share/ament_cmake").is_dir() {
        return installed::left_out("no ament_cmake here (Debian: ament-cmake)");
    }
    let prefix = package("ament", "-DPython3_EXECUTABLE=/usr/bin/python3");
    assert!(prefix.join("share/ament_index/resource_index/packages/ur5_armgen").is_file());

    // A workspace of the package and of a package that depends on it.
    if !installed::runs("colcon", &["--help"]) {
        return installed::left_out("no `colcon` here (Debian: colcon, python3-colcon-cmake, python3-colcon-ros)");
    }
    let workspace = folder.join("workspace");
    let controller = workspace.join("src/controller");
    fs::create_dir_all(&controller).expect("a folder");
    generate(&workspace.join("src"), &page);
    fs::copy(folder.join("main.c"), controller.join("main.c")).expect("main.c");
    let lists = format!("{installed}install(TARGETS controller DESTINATION bin)\n");
    fs::write(controller.join("CMakeLists.txt"), lists).expect("CMakeLists.txt");
    let manifest = "<package format=\"3\"><name>controller</name><version>0.1.0</version><description>A controller</description>\
        <maintainer email=\"ada@example.org\">Ada Lovelace</maintainer><license>MIT</license><buildtool_depend>cmake</buildtool_depend>\
        <depend>ur5_armgen</depend><export><build_type>cmake</build_type></export></package>\n";
    fs::write(controller.join("package.xml"), manifest).expect("package.xml");
    run(&workspace, "colcon", &["build", "--cmake-args", "-DPython3_EXECUTABLE=/usr/bin/python3"]);
    let built = workspace.join("install/controller/bin/controller").display().to_string();
    assert_eq!(run(&folder, &built, &[]), block(&page, "text"));
}
