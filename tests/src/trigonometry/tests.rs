//! Identities that hold, near misses that must fail, faults.

use super::*;

#[track_caller]
fn equal(a: &str, b: &str) {
    let (a, b) = (Exact::read(a).expect(a), Exact::read(b).expect(b));
    assert!(a == b, "{a}\n  is not\n{b}");
}

#[track_caller]
fn different(a: &str, b: &str) {
    assert!(Exact::read(a).expect(a) != Exact::read(b).expect(b), "{a} and {b} are called equal");
}

#[test]
fn identities() {
    equal("sin(q1)^2 + cos(q1)^2", "1");
    equal("cos(q1 + q2)", "cos(q1)*cos(q2) - sin(q1)*sin(q2)");
    equal("sin(q1 - q2)", "sin(q1)*cos(q2) - sin(q2)*cos(q1)");
    equal("cos(2*q1)", "1 - 2*sin(q1)^2");
    equal("sin(3*q2)", "3*sin(q2) - 4*sin(q2)^3");
    equal("2*sin(q1)*cos(q2)", "sin(q1+q2) + sin(q1-q2)");
    equal("cos(q1+q2+q3)^2 + sin(q3+q2+q1)^2", "1");
    equal("cos(-q1)", "cos(q1)");
    equal("sin(-q1)", "-sin(q1)");
    equal("sin(q1 + pi/2)", "cos(q1)");
    equal("cos(q1 - pi)", "-cos(q1)");
    equal("cos(q1 + 17*pi)", "-cos(q1)");
    equal("tan2*cos(q1)", "cos(q1)*tan2");
    equal("(a+b)^3", "a^3 + 3*a^2*b + 3*a*b^2 + b^3");
    equal("0.1 + 0.2", "3/10");
    equal("1e-3", "1/1000");
    equal("10.50e2", "1050");
    equal("10*cos(q2) + 10763/500", "21.526 + cos(q2)*10");
    equal("m/(m+n) + n/(m+n)", "1");
    equal("1/(1+cos(q1))", "(1-cos(q1))/sin(q1)^2");
    equal("sign(dq1)*c", "c*sign(dq1)");
    equal("sign(-2*dq1)", "-sign(dq1)");
    equal("--q1", "q1");
    equal("2^-2", "1/4");
}

#[test]
fn constants() {
    equal("sqrt(12)", "2*sqrt(3)");
    equal("sqrt(2)*sqrt(3)", "sqrt(6)");
    equal("1/sqrt(2)", "sqrt(2)/2");
    equal("sqrt(1/2)", "sqrt(2)/2");
    equal("sqrt(0.25)", "1/2");
    equal("1/(1+sqrt(2))", "sqrt(2)-1");
    equal("sqrt(1000000007*1000000007)", "1000000007");
    equal("cos(pi/12)", "(sqrt(6)+sqrt(2))/4");
    equal("sin(5*pi/12)", "cos(pi/12)");
    equal("sin(pi/6)", "1/2");
    equal("cos(pi/6)", "sqrt(3)/2");
    equal("cos(-3*pi/4)", "-sqrt(2)/2");
    equal("sin(q1 + pi/3)", "sin(q1)/2 + sqrt(3)/2*cos(q1)");
    equal("cos(q1 + 0.7)", "cos(q1)*cos(7/10) - sin(q1)*sin(0.7)");
    equal("sin(7/10)^2 + cos(0.7)^2", "1");
    equal("sin(-0.7)", "-sin(0.7)");
    equal("cos(pi/5 + 2*pi)", "cos(-pi/5)");
    equal("pi*(1/2)", "pi/2");
}

#[test]
fn near_misses() {
    different("sin(q1)^2 + cos(q1)^2", "1 + 1e-300");
    different("cos(q1 + q2)", "cos(q1)*cos(q2) + sin(q1)*sin(q2)");
    different("cos(q1 + q2)", "cos(q1) + cos(q2)");
    different("sin(q1)", "q1");
    different("sin(q1)^2", "sin(q1^1)");
    different("cos(2*q1)", "2*cos(q1)");
    different("10*cos(q2) + 10763/500", "10*cos(q2) + 10763.000000000000001/500");
    different("cos(pi/2)", "6e-17");
    different("sqrt(2)", "1.4142135623730951");
    different("sqrt(2)", "-sqrt(2)");
    different("sqrt(1000000007)", "sqrt(1000000009)");
    different("pi", "3.141592653589793");
    different("sin(1.5707963267948966)", "1");
    different("sin(0.7)", "sin(0.7000000001)");
    different("dq1", "ddq1");
    different("m/(m+n)", "n/(m+n)");
    different("sign(dq1)^2", "1");
    different("q1", "q2");
    different("0", "1e-300");
}

#[test]
fn faults() {
    for text in [
        "1/0",
        "1/(sin(q1)^2+cos(q1)^2-1)",
        "sin(q1/2)",
        "sin(q1*q2)",
        "sin(cos(q1))",
        "sin(1/q1)",
        "2^q1",
        "2^0.5",
        "2^100000",
        "1e100000",
        "sqrt(-1)",
        "sqrt(q1)",
        "tan(q1)",
        "sign(q1+q2)",
        "cos(",
        "q1 q2",
        "0^-1",
    ] {
        assert!(Exact::read(text).is_err(), "{text} is read");
    }
}

#[test]
fn derivatives() {
    let check = |text: &str, name: &str, expected: &str| {
        assert!(Exact::read(text).unwrap().derivative(name) == Exact::read(expected).unwrap(), "d({text})/d{name}");
    };
    check("sin(q1+q2)", "q1", "cos(q1+q2)");
    check("cos(2*q1)^2", "q1", "-2*sin(4*q1)");
    check("q3*sin(q1)*m", "q3", "m*sin(q1)");
    check("q1^3*cos(q1)", "q1", "3*q1^2*cos(q1) - q1^3*sin(q1)");
    check("1/(1+q1)", "q1", "-1/(1+q1)^2");
    check("sin(0.7)*pi", "q1", "0");
}

#[test]
fn names_stand_for_expressions() {
    let names = Names::from([("t1".to_owned(), Exact::read("q1+q2").unwrap()), ("m".to_owned(), Exact::integer(15))]);
    let read = Exact::read_with("m*cos(t1 - q2)", &names).unwrap();
    assert!(read == Exact::read("15*cos(q1)").unwrap());
    assert_eq!(read.names().into_iter().collect::<Vec<_>>(), ["q1"]);
}
