/// What is left of Stribeck friction at a rate: two units of roundoff of the function, and two of |rate| / velocity, which weigh as much as that is;
/// what is below 1e-17 is 0.
fn fading(rate: Real, velocity: Real) -> Bounded {
    let (value, times) = (stribeck(rate, velocity), (rate.abs() / velocity).min(64.0));
    let cut = if value == 0.0 { 1e-17 } else { 0.0 };
    Bounded { value, error: (2.1 + 2.1 * times) * UNIT * value + cut }
}
