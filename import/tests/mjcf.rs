//! Parts of MuJoCo models that are computed: mass distributions of shapes, what flags switch off, what other files hold.

use crate::common;

use std::collections::BTreeMap;

use armgen_codegen::diagnostic::Colour;
use armgen_codegen::source::Source;
use armgen_import::{import, included, Imported, Options};

#[track_caller]
fn imported(text: &str) -> Imported {
    let source = Source::new("model.xml", text);
    let (imported, diagnostics) = import(&source, &Options::default());
    imported.unwrap_or_else(|| panic!("{}", diagnostics.render(&source, Colour::Never)))
}

/// MuJoCo 4.0.0 of `mjcf/shapes.xml` at q = (0.3, -0.7, 1.1): of each body m, m p and the inertia about the origin of the world (xx, xy, yy, xz,
/// yz, zz), from `body_mass`, `xipos`, `ximat` and `body_inertia`.
const SHAPES: [[f64; 10]; 3] = [
    [
        3.3280986644251245,
        0.07121344500339191,
        0.132586524550555,
        1.1648345325487934,
        0.5201989780429502,
        -0.014663116640983208,
        0.48614404299240943,
        -0.029045744906734696,
        -0.05792683318397231,
        0.049584315893317826,
    ],
    [
        1.1225663103256525,
        -0.14064102100491283,
        0.15807819980292387,
        0.777594643168814,
        0.5719918558765136,
        0.020504394215282783,
        0.5666103882938333,
        0.09965510657308173,
        -0.11386957815158358,
        0.04784086561360928,
    ],
    [
        0.8661946710584651,
        0.1648964952464427,
        0.09201237935334551,
        0.7068807704618996,
        0.6003567934373604,
        -0.01753915718837271,
        0.6106686070346348,
        -0.13462206170607738,
        -0.07071463656991994,
        0.053196005874708664,
    ],
];

/// Every shape by mass and by density, with `size` and `fromto`, in frames, groups and classes.
#[test]
fn shapes_have_the_masses_that_mujoco_computes() {
    let arm = common::valid(&imported(include_str!("mjcf/shapes.xml")).yaml);
    let [values, _] = common::state(&arm);
    for (body, (found, expected)) in values.chunks(10).zip(&SHAPES).enumerate() {
        for (k, (a, b)) in found.iter().zip(expected).enumerate() {
            assert!((a - b).abs() <= 1e-13 * expected[0], "body {body}, value {k}: {a} and {b}");
        }
    }
}

/// The mass and the principal moments of one shape, exactly: m (b² + c²)/12 of a box of sides 0.1, 0.1 and 0.5, and so on.
#[test]
fn shapes_are_exact() {
    let of = |geom: &str| {
        let yaml = imported(&format!("<mujoco><worldbody><body><joint/>{geom}</body></worldbody></mujoco>")).yaml;
        let line = |key: &str| yaml.lines().find_map(|line| line.trim().strip_prefix(key)).unwrap_or_default().to_owned();
        (line("mass: "), line("inertia: "))
    };
    let (mass, inertia) = of(r#"<geom type="box" size="0.05 0.05 0.25" density="500"/>"#);
    assert_eq!((mass.as_str(), inertia.as_str()), ("2.5", "{xx: 13/240, yy: 13/240, zz: 1/240}"));
    let (mass, inertia) = of(r#"<geom size="0.1"/>"#);
    assert_eq!((mass.as_str(), inertia.as_str()), ("4/3*pi", "{xx: 2/375*pi, yy: 2/375*pi, zz: 2/375*pi}"));
    // A cylinder of length 3/5 and half balls of radius 1/10: s = m 4r/(4r + 6l) = 2/11.
    let (mass, inertia) = of(r#"<geom type="capsule" size="0.1 0.3" mass="1"/>"#);
    assert_eq!(mass, "1");
    let (r, l, s) = (0.1f64, 0.3f64, 2.0 / 11.0);
    let across = (1.0 - s) * (3.0 * r * r + 4.0 * l * l) / 12.0 + s * (0.4 * r * r + l * l + 0.75 * r * l);
    let along = (1.0 - s) * r * r / 2.0 + s * 0.4 * r * r;
    let number = |key: &str| -> f64 {
        let (_, rest) = inertia.split_once(key).expect("an element");
        let (p, q) = rest[..rest.find([',', '}']).expect("an end")].trim().split_once('/').expect("a fraction");
        p.parse::<f64>().expect("a number") / q.parse::<f64>().expect("a number")
    };
    assert!((number("xx:") - across).abs() < 1e-16 && (number("zz:") - along).abs() < 1e-16, "{inertia}");
}

/// As in MuJoCo 4.0.0: `inertiafromgeom` and groups choose between given and computed inertias. Balancing changes only tensors that
/// violate the triangle inequality.
#[test]
fn the_compiler_chooses_what_has_mass() {
    let model = |compiler: &str, tensor: &str, geom: &str| {
        format!(
            "<mujoco><compiler {compiler}/><worldbody><body><joint/><inertial pos='0 0 0' mass='7' diaginertia='{tensor}'/>{geom}</body></worldbody></mujoco>"
        )
    };
    let mass = |compiler: &str, geom: &str| {
        let yaml = imported(&model(compiler, "1 1 1", geom)).yaml;
        yaml.lines().find_map(|line| line.trim().strip_prefix("mass: ")).expect("a mass").to_owned()
    };
    let geom = "<geom size='0.1' mass='3'/>";
    assert_eq!(mass("", geom), "7");
    assert_eq!(mass("inertiafromgeom='false'", geom), "7");
    assert_eq!(mass("inertiafromgeom='true'", geom), "3");
    assert_eq!(mass("inertiafromgeom='true' inertiagrouprange='1 2'", geom), "7");
    assert_eq!(mass("inertiafromgeom='true'", "<geom size='0.1' mass='0'/>"), "7");
    assert_eq!(mass("balanceinertia='true'", geom), "7");
    let unbalanced = model("balanceinertia='true'", "1 1 3", "");
    let (imported, diagnostics) = import(&Source::new("model.xml", unbalanced), &Options::default());
    assert!(imported.is_none() && diagnostics.iter().all(|fault| fault.message.contains("balanceinertia")));
}

/// Each of these flags changes the accelerations of MuJoCo. Import drops the disabled effects and reports them.
#[test]
fn flags_switch_forces_off() {
    let with = |flag: &str| {
        let text = format!(
            "<mujoco><option><flag {flag}/></option><worldbody><body><joint name='j' axis='1 0 0' stiffness='5' damping='3' frictionloss='0.7' armature='0.2'/>\
             <inertial pos='0 0 .1' mass='1' diaginertia='.01 .01 .01'/></body></worldbody></mujoco>"
        );
        let Imported { yaml, report } = imported(&text);
        let arm = common::valid(&yaml);
        let joint = &arm.joints[0];
        let said = report.lines().iter().filter(|line| line.contains("switches")).count();
        assert!(joint.armature.is_some());
        (joint.spring.is_some(), joint.viscous.is_some(), joint.coulomb.is_some(), said)
    };
    for (flag, expected) in [
        ("contact='disable'", (true, true, true, 0)),
        ("spring='disable'", (false, true, true, 1)),
        ("damper='disable'", (true, false, true, 1)),
        ("passive='disable'", (false, false, true, 2)),
        ("frictionloss='disable'", (true, true, false, 1)),
        ("constraint='disable'", (true, true, false, 1)),
        ("spring='disable' damper='disable' frictionloss='disable'", (false, false, false, 3)),
        ("spring='enable' damper='enable'", (true, true, true, 0)),
    ] {
        assert_eq!(with(flag), expected, "{flag}");
    }
}

/// What constraints are switched off couples nothing.
#[test]
fn equalities_that_are_switched_off_are_none() {
    let with = |flag: &str| {
        let body = "<inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/>";
        let text = format!(
            "<mujoco><option><flag {flag}/></option><worldbody><body><joint name='a'/>{body}<body><joint name='b'/>{body}</body></body></worldbody>\
             <equality><joint joint1='a' joint2='b'/></equality></mujoco>"
        );
        let Imported { yaml, report } = imported(&text);
        let note = "equalities that the model switches off are left out: `a` does not follow `b`";
        let follows = yaml.contains("follows: {b: 1}");
        assert_eq!(report.lines().iter().any(|line| line == note), !follows, "{:?}", report.lines());
        follows
    };
    assert!(with("contact='disable'") && !with("equality='disable'") && !with("constraint='disable'"));
}

/// q1 - ref1 = c0 + c1 (q2 - ref2), as MuJoCo's documentation of `polycoef` has it.
#[test]
fn an_equality_of_two_joints_makes_the_first_follow_the_second() {
    let with = |first: &str, second: &str, polycoef: &str| {
        let body = "<inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/>";
        let text = format!(
            "<mujoco><worldbody><body name='hand'><joint name='turn'/>{body}\
             <body><joint name='a' {first}/>{body}</body><body name='end'><joint name='b' {second}/>{body}</body></body></worldbody>\
             <equality><joint joint1='a' joint2='b' {polycoef}/><joint joint1='a' joint2='turn' active='false'/></equality></mujoco>"
        );
        let options = Options { tip: Some("end".into()), ..Options::default() };
        let Imported { yaml, report } = import(&Source::new("model.xml", text), &options).0.expect("an arm");
        assert_eq!(report.lines().iter().filter(|line| line.contains("`solref`")).count(), 1);
        assert!(report.lines().iter().all(|line| !line.contains("left out: 2 equality")));
        let coupling = common::valid(&yaml).coupling.expect("a coupling");
        let variable = &coupling.variables[2];
        let factors: Vec<(usize, f64)> = variable.factors.iter().map(|(of, factor)| (*of, factor.to_f64())).collect();
        assert!(matches!(factors[..], [(1, _)]), "{yaml}");
        (factors[0].1, variable.offset.to_f64())
    };
    let (slide, far) = ("type='slide'", "type='slide' ref='0.5'");
    assert_eq!(with("", "", ""), (1.0, 0.0));
    assert_eq!(with("", "", "polycoef='0.25 -2 0 0 0'"), (-2.0, 0.25));
    assert_eq!(with(slide, far, "polycoef='0.25 -0.3'"), (-0.3, 0.25 + 0.3 * 0.5));
    assert_eq!(with(far, far, "polycoef='-1 2'"), (2.0, -1.0 + 0.5 - 2.0 * 0.5));
    let (factor, offset) = with("ref='90'", "ref='-30'", "polycoef='0 2'");
    assert!(factor == 2.0 && (offset - 150_f64.to_radians()).abs() < 1e-15, "{offset}");
    assert_eq!(with("range='-90 90'", "range='-60 60' ref='30'", "polycoef='0 1 0 0 0'").0, 1.0);
}

/// Files by their paths; a missing file is an error.
fn written_out(files: &[(&str, &str)]) -> Result<String, String> {
    let files: BTreeMap<&str, &str> = files.iter().copied().collect();
    let read = |path: &str| files.get(path).map(|text| (*text).to_owned()).ok_or_else(|| format!("no {path}"));
    let source = Source::new("model.xml", files["model.xml"]);
    match included(&source, &read) {
        Ok(source) => Ok(source.text().to_owned()),
        Err(fault) => Err(format!("{}:{}", source.place(fault.span().start), fault.message)),
    }
}

#[test]
fn what_a_model_includes_stands_in_its_place() {
    let body = "<mujocoinclude>\n  <!-- a -- b -->\n  <body name='b'><joint name='j'/>\n<include file=\"parts/mass.xml\"/></body>\n</mujocoinclude>";
    let mass = "<?xml version='1.0'?>\n<x><inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/></x>";
    let model =
        "<mujoco>\n<include file='defaults.xml'/>\n<worldbody><include file='./body.xml'/></worldbody>\n<wrong/></mujoco>";
    let files = [("model.xml", model), ("body.xml", body), ("parts/mass.xml", mass), ("defaults.xml", "<mujoco/>")];
    let text = written_out(&files).expect("all files are there");
    assert!(text.lines().count() == 4 && text.ends_with("\n<wrong/></mujoco>"), "{text}");
    let plain = "<mujoco><worldbody><body name='b'><joint name='j'/><inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/></body></worldbody></mujoco>";
    let joints =
        |text: &str| imported(text).yaml.lines().filter(|line| !line.contains('#')).map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(joints(&text), joints(plain));
    // Nothing to include: nothing is changed.
    assert_eq!(written_out(&[("model.xml", plain)]).as_deref(), Ok(plain));
    assert_eq!(
        written_out(&[("model.xml", "<robot><include file='a'/></robot>")]).as_deref(),
        Ok("<robot><include file='a'/></robot>")
    );
}

#[test]
fn what_cannot_be_included_is_told_with_its_place() {
    let model = |file: &str| format!("<mujoco>\n  <include file=\"{file}\"/></mujoco>");
    let told = |file: &str, others: &[(&str, &str)]| {
        let model = model(file);
        written_out(&[&[("model.xml", model.as_str())], others].concat()).expect_err("it cannot be included")
    };
    assert_eq!(told("a.xml", &[]), "2:18:cannot read `a.xml`: no a.xml");
    assert_eq!(told("../a.xml", &[]), "2:18:`../a.xml` is outside of the model's folder");
    assert_eq!(told("/etc/a.xml", &[]), "2:18:`/etc/a.xml` is outside of the model's folder");
    let ring = [("a.xml", "<a>\n<include file='b.xml'/></a>"), ("b.xml", "<b><include file='a.xml'/></b>")];
    assert!(told("a.xml", &ring).contains("`a.xml` is included a second time"));
    assert!(told("a.xml", &[("a.xml", "<a>\n\n<b></a>")]).starts_with("2:18:not well-formed XML"));
    assert!(told("a.xml", &[("a.xml", "<a>\n\n<b></a>")]).ends_with("(`a.xml`, line 3)"));
    let many: Vec<(String, String)> =
        (0..40).map(|k| (format!("{k}.xml"), format!("<a><include file='{}.xml'/></a>", k + 1))).collect();
    let many: Vec<(&str, &str)> = many.iter().map(|(name, text)| (name.as_str(), text.as_str())).collect();
    assert!(told("0.xml", &many).contains("more than 16 files"));
    assert!(written_out(&[("model.xml", "<mujoco><include/></mujoco>")]).expect_err("no file").contains("names no file"));
}
