/// The sign of a value; it can be any where that cannot be told from 0.
fn sign_of(a: Bounded) -> Bounded {
    let told = a.value.abs() > a.error || a.error == 0.0;
    Bounded { error: if told { 0.0 } else { 2.0 }, ..sign(a.value) }
}
