//! The generator as a WebAssembly module without imports: a request as JSON goes in, an answer as JSON comes out.
//!
//! ```text
//! room(n) -> address       where the n bytes of a request go
//! call() -> n              answers it; the length of the answer
//! answer() -> address      where the answer is
//! ```
//!
//! `answers.rs` has the requests. A caller that sees a trap makes a new instance: this one's memory is lost.

mod answers;

use std::sync::{Mutex, MutexGuard, PoisonError};

static REQUEST: Mutex<Vec<u8>> = Mutex::new(Vec::new());
static ANSWER: Mutex<Vec<u8>> = Mutex::new(Vec::new());

fn locked(bytes: &'static Mutex<Vec<u8>>) -> MutexGuard<'static, Vec<u8>> {
    bytes.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Makes room for a request of `length` bytes; its address.
#[expect(unsafe_code, reason = "an exported name")]
#[no_mangle]
pub extern "C" fn room(length: usize) -> usize {
    let mut request = locked(&REQUEST);
    *request = vec![0; length];
    request.as_mut_ptr() as usize
}

/// Answers the request; the length of the answer.
#[expect(unsafe_code, reason = "an exported name")]
#[no_mangle]
pub extern "C" fn call() -> usize {
    let request = std::mem::take(&mut *locked(&REQUEST));
    let text = answers::of(&request).to_string();
    let mut answer = locked(&ANSWER);
    *answer = text.into_bytes();
    answer.len()
}

/// The address of the answer.
#[expect(unsafe_code, reason = "an exported name")]
#[no_mangle]
pub extern "C" fn answer() -> usize {
    locked(&ANSWER).as_ptr() as usize
}
