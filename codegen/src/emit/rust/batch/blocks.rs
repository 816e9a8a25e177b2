/// The states of a block side by side; lanes without a state hold zeros.
#[allow(clippy::all)]
fn gather<const N: usize>(states: &[[Real; N]], block: &mut [[Real; LANES]; N]) {
    if let Some(states) = states.first_chunk() {
        return side_by_side(states, block);
    }
    let mut filled = [[0.0; N]; LANES];
    for (to, from) in filled.iter_mut().zip(states) {
        *to = *from;
    }
    side_by_side(&filled, block);
}

/// The same of a whole block. Compiled by itself, with no number of states to test, it becomes vector instructions.
#[allow(clippy::all)]
#[inline(never)]
fn side_by_side<const N: usize>(states: &[[Real; N]; LANES], block: &mut [[Real; LANES]; N]) {
    for k in 0..LANES {
        for i in 0..N {
            block[i][k] = states[k][i];
        }
    }
}

/// One lane of a block.
#[allow(clippy::all)]
fn scatter(k: usize, block: &[[Real; LANES]], state: &mut [Real]) {
    for (value, lanes) in state.iter_mut().zip(block) {
        *value = lanes[k % LANES];
    }
}
