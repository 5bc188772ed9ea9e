//! A bounded share of the soak: random operators, and rules that nothing they do may break.

use virtual_lathe::operate::soak::{Job, run};

#[test]
fn some_sessions_break_no_rule_and_the_same_seed_gives_the_same_train() {
    let folder = std::env::temp_dir().join("handcnc-soak");
    let job = Job { hours: 0.1, seed: SEED, folder, failures: 1, ..Job::default() };
    let (first, second) = (run(&job, false), run(&job, false));
    assert!(first.broken.is_empty(), "{:?}", first.broken);
    assert_eq!(first.hash, second.hash);
}

/// Its sessions find nothing; others may: `soak` looks for them.
const SEED: u64 = 16;
