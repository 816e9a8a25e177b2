//! What a written file keeps for later logs: it is read as it was written, and refused where it is not.

use armgen_codegen::source::Source;
use armgen_identify::baseline::Baseline;
use armgen_identify::finding::Code;

use crate::arms::{arm, Random, ELBOW, SCARA};

#[test]
fn delays_and_spreads_are_read_as_they_were_written() {
    let mut random = Random(1);
    for text in [ELBOW, SCARA] {
        let arm = arm(text);
        assert_eq!(Baseline::read(&Source::new("arm.yaml", text), &arm).expect("no fault"), None);
        for end in ["\n", "\r\n"] {
            let text = text.trim_end().replace('\n', end);
            let mut written = text.clone();
            // Lines of before are replaced.
            for size in [1e-9, 1.0, 3e4] {
                let delays = (0..3).map(|_| 1e-5 * random.within(-1000.0, 2500.0).round()).collect();
                let spreads = (0..3).map(|_| size * random.within(1.0, 9.999)).collect();
                let baseline = Baseline { delays, spreads };
                written = baseline.written(&arm, &written);
                assert!(written.starts_with(&text) && written.matches("# identified joint ").count() == 3, "{written}");
                assert_eq!(written.matches('\n').count(), written.matches(end).count());
                let read = Baseline::read(&Source::new("arm.yaml", written.as_str()), &arm).expect("good").expect("there");
                for (a, b) in baseline.delays.iter().zip(&read.delays) {
                    assert!((a - b).abs() < 1e-9, "{a} {b}");
                }
                for (a, b) in baseline.spreads.iter().zip(&read.spreads) {
                    assert!((a / b - 1.0).abs() < 1e-3, "{a} {b}");
                }
            }
        }
    }
}

#[test]
fn a_line_that_is_not_as_written_has_its_place() {
    let arm = arm(SCARA);
    let baseline = Baseline { delays: vec![4e-3, 0.0, -1e-3], spreads: vec![0.2, 0.1, 12.0] };
    let written = baseline.written(&arm, SCARA);
    let first = 1 + SCARA.matches('\n').count();
    let lines: Vec<&str> = written.lines().skip(first - 1).collect();
    assert_eq!(lines[2], "# identified joint j3: delay -1.00 ms, residual 12.00 N");
    let place = |text: &str| {
        let fault = Baseline::read(&Source::new("arm.yaml", text), &arm).expect_err("it is faulty");
        assert!(fault.code == Code::BadBaseline && fault.log == "arm.yaml" && fault.help.contains("remove all such lines"));
        (fault.line - first, fault.at, fault.text)
    };
    for (from, to, line, at, words) in [
        ("delay 4.00", "delay 4,00", 0, 24, "`delay 4,00 ms` is not `delay NUMBER ms`"),
        ("delay 4.00", "delay nan", 0, 24, "at most 1000"),
        ("delay 4.00", "delay 1e4", 0, 24, "at most 1000"),
        ("delay 4.00 ms", "delay 4.00 s", 0, 24, "`delay 4.00 s`"),
        ("residual 0.1000", "residual 0", 1, 39, "above 0"),
        ("residual 0.1000", "residual -0.1", 1, 39, "above 0"),
        ("12.00 N", "12.00 N m", 2, 40, "`residual NUMBER N`"),
        ("12.00 N", "12.00 N, more", 2, 58, "`more` is not expected here"),
        ("joint j2:", "joint j3:", 1, 20, "joint `j2` is expected here"),
        ("joint j2:", "joint j2", 1, 20, "joint `j2` is expected here"),
        (lines[1], "", 2, 20, "joint `j2` is expected here"),
        (lines[2], "", 1, 0, "no line of joint `j3` follows"),
        (lines[2], &format!("{0}\n{0}", lines[2]), 3, 1, "no further joint"),
    ] {
        let (found, column, text) = place(&written.replacen(from, to, 1));
        assert!((found, column) == (line, at) && text.contains(words), "{from}: {found}, {column}, {text}");
    }
}
