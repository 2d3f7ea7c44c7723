//! The best force inside a friction cone: single problems, regular and degenerate.

use std::hint::black_box;

use contactsense::best_cone_force;
use criterion::{criterion_group, criterion_main, Criterion};
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

const FRICTION: f64 = 0.5;
/// So many that no branch can be learnt.
const PROBLEMS: usize = 4096;

/// Gram matrix and products of torques of random forces on as many joints, with noise.
fn problem(joints: usize, number: usize) -> (Matrix3<f64>, Vector3<f64>) {
    let mut state = number as f64;
    let mut random = || {
        // Fractions of a fast sine are as irregular as this needs.
        state = (state + 0.37).sin() * 1e4;
        state -= state.floor();
        2.0 * state - 1.0
    };
    let mut torques = SMatrix::<f64, 7, 3>::from_fn(|i, _| if i < joints { random() } else { 0.0 });
    if joints > 3 {
        // The normal force of most contacts is felt best.
        torques.column_mut(0).scale_mut(2.0);
    }
    let force = Vector3::new(random().abs(), random(), random());
    let measured = torques * force + SVector::<f64, 7>::from_fn(|_, _| 0.2 * random());
    (torques.tr_mul(&torques), torques.tr_mul(&measured))
}

fn cone(c: &mut Criterion) {
    let mut group = c.benchmark_group("friction cone, best force");
    let kinds: [(&str, &[usize]); 4] = [
        ("7 joints", &[7]),
        ("2 joints", &[2]),
        ("1 joint", &[1]),
        ("1 to 7 joints", &[1, 2, 3, 4, 5, 6, 7]),
    ];
    for (name, joints) in kinds {
        let problems: Vec<_> = (0..PROBLEMS).map(|k| problem(joints[k % joints.len()], k)).collect();
        let mut next = 0;
        group.bench_function(name, |b| {
            b.iter(|| {
                next = (next + 1) % PROBLEMS;
                let (gram, products) = &problems[next];
                best_cone_force(black_box(gram), black_box(products), FRICTION).objective
            })
        });
    }
    group.finish();
}

criterion_group!(benches, cone);
criterion_main!(benches);
