/// The states of a block side by side; lanes without a state hold zeros.
#[allow(clippy::all)]
fn gather<const N: usize>(states: &[[Real; N]]) -> [[Real; LANES]; N] {
    let mut block = [[0.0; LANES]; N];
    for (state, k) in states.iter().zip(0..LANES) {
        for (lanes, value) in block.iter_mut().zip(state) {
            lanes[k] = *value;
        }
    }
    block
}

/// One lane of a block.
#[allow(clippy::all)]
fn scatter(k: usize, block: &[[Real; LANES]], state: &mut [Real]) {
    for (value, lanes) in state.iter_mut().zip(block) {
        *value = lanes[k % LANES];
    }
}
