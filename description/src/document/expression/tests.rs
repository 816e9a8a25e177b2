use super::*;

fn read(text: &str) -> Result_ {
    parse(&Scalar { text: text.into(), plain: true, verbatim: Some(0) }, Span::new(0, text.len()))
}

/// The expression with every operation in parentheses.
fn printed(e: &Expression) -> String {
    match &e.kind {
        ExpressionKind::Decimal(value) => value.to_string(),
        ExpressionKind::Pi => "pi".into(),
        ExpressionKind::Name(name) => name.clone(),
        ExpressionKind::Negate(a) => format!("(-{})", printed(a)),
        ExpressionKind::Degrees(a) => format!("deg({})", printed(a)),
        ExpressionKind::Root(a) => format!("sqrt({})", printed(a)),
        ExpressionKind::InUnit(..) => unreachable!("a text names no unit"),
        ExpressionKind::Binary(operator, a, b) => {
            let sign = match operator {
                Operator::Add => '+',
                Operator::Subtract => '-',
                Operator::Multiply => '*',
                Operator::Divide => '/',
            };
            format!("({}{sign}{})", printed(a), printed(b))
        }
    }
}

#[track_caller]
fn check(text: &str, expected: &str) {
    match read(text) {
        Ok(e) => assert_eq!(printed(&e), expected),
        Err(d) => panic!("{text}: {d:?}"),
    }
}

/// `marked` is the text and, below it, a row of `~` under the place of the error.
#[track_caller]
fn check_error(marked: &str, code: Code) {
    let (text, row) = marked.trim_matches('\n').split_once('\n').expect("two lines");
    let from = row.find('~').unwrap_or(row.len());
    let (from, count) = (row[..from].chars().count(), row.matches('~').count());
    let byte = |n: usize| text.char_indices().nth(n).map_or(text.len(), |(at, _)| at);
    let error = read(text).expect_err(text);
    assert_eq!((error.code, error.span()), (code.into(), Span::new(byte(from), byte(from + count))), "{error:?}");
    assert!(!error.help.is_empty() && !error.message.is_empty());
}

#[test]
fn precedence_and_association() {
    check("1+2*3", "(1+(2*3))");
    check("8/4/2", "((8/4)/2)");
    check("8-4-2", "((8-4)-2)");
    check("-a*b", "((-a)*b)");
    check("2*-a", "(2*(-a))");
    check("2--+-1", "(2-(-(-1)))");
    check("(1+2)*3", "((1+2)*3)");
    check("deg( 90 )", "deg(90)");
    check(" sqrt(2) / 2 ", "(sqrt(2)/2)");
    check("90*pi/180", "((90*pi)/180)");
    check("r\u{e4}der_1 * x2", "(r\u{e4}der_1*x2)");
    check("1\n + 2", "(1+2)");
}

#[test]
fn a_decimal_is_the_fraction_that_its_digits_say() {
    check("0.1", "1/10");
    check("0.10", "1/10");
    check("1e-3", "1/1000");
    check("2.5E+2", "250");
    check("5e-5", "1/20000");
    check(".5", "1/2");
    check("5.", "5");
    check("007", "7");
    check("0e999999999999999999999", "0");
    check("-9.81", "(-981/100)");
    check("1000000000000000000000000001", "1000000000000000000000000001");
}

#[test]
fn errors_stand_where_they_are() {
    use Code::{BadExpression, NotFinite, OutOfRange, TooComplex};
    check_error("1 +\n  ~", BadExpression);
    check_error("(1 + 2\n~", BadExpression);
    check_error("1 + 2)\n     ~", BadExpression);
    check_error("pi/*2\n  ~~", BadExpression);
    check_error("2^3\n ~", BadExpression);
    check_error("2**3\n ~~", BadExpression);
    check_error("2*(3 4)\n     ~", BadExpression);
    check_error("2pi\n ~~", BadExpression);
    check_error("5 kg\n  ~~", BadExpression);
    check_error("1e\n ~", BadExpression);
    check_error("1.2.3\n~~~~~", BadExpression);
    check_error("0x10\n~~~~", BadExpression);
    check_error("1_000\n~~~~~", BadExpression);
    check_error("sin(1)\n~~~", BadExpression);
    check_error("deg 90\n~~~", BadExpression);
    check_error("\u{e4} + \u{b0}\n    ~", BadExpression);
    check_error("\u{3c0}/2\n~", BadExpression);
    check_error("0,5\n ~", BadExpression);
    check_error(".\n~", BadExpression);
    check_error("-.inf\n ~~~~", NotFinite);
    check_error("2*.NaN\n  ~~~~", NotFinite);
    check_error("a*1e1001\n  ~~~~~~", OutOfRange);
    check_error("1e-9999999999999999999\n~~~~~~~~~~~~~~~~~~~~~~", OutOfRange);
    let deep = format!("{}1{}", "(".repeat(40), ")".repeat(40));
    check_error(&format!("{deep}\n{}~", " ".repeat(33)), TooComplex);
}

#[test]
fn long_inputs_end_soon() {
    for text in ["9".repeat(1_000_000), "-".repeat(1_000_000), "1+".repeat(500_000), "(".repeat(1_000_000)] {
        assert_eq!(read(&text).expect_err("too long").code, Code::TooComplex);
    }
    assert_eq!(read(&"1".repeat(201)).expect_err("too many digits").code, Code::TooComplex);
    assert!(read(&"1".repeat(200)).is_ok());
    assert!(read("1+".repeat(129).trim_end_matches('+')).is_ok());
    let long = read("1*".repeat(130).trim_end_matches('*')).expect_err("too many operators");
    assert_eq!((long.code, long.span()), (Code::TooComplex.into(), Span::new(257, 258)));
    assert_eq!(read(&"-".repeat(1000)).expect_err("too deep").code, Code::TooComplex);
}
