//! From features to probabilities.

use super::class::ContactClass;
use super::features::{Features, FEATURES};
use super::followed::Followed;
use super::weights::{Weights, OF_ENDED, OF_LASTING, OF_YOUNG, YOUNG};

/// What a contact is, by what is known of it.
pub(super) fn judge(contact: &Followed, running: bool, prior: &[f64; 4]) -> ContactClass {
    let features = contact.features();
    let duration = contact.last - contact.since;
    let weights = if !running {
        &OF_ENDED
    } else if duration < YOUNG {
        &OF_YOUNG
    } else {
        &OF_LASTING
    };
    let (logits, contributions) = explain(weights, &features, prior);
    let largest = logits[0].max(logits[1]).max(logits[2]);
    let [clamped, transient, sustained] = [0, 1, 2].map(|kind: usize| (logits[kind] - largest).exp());
    let sum = clamped + transient + sustained;
    ContactClass {
        id: contact.id,
        running,
        since: contact.since,
        duration,
        clamped: clamped / sum,
        transient: transient / sum,
        sustained: sustained / sum,
        intended: 1.0 / (1.0 + (-logits[3]).exp()),
        features,
        contributions,
    }
}

/// The logits, and what each feature adds to them.
fn explain(weights: &Weights, features: &Features, prior: &[f64; 4]) -> ([f64; 4], [[f64; FEATURES]; 4]) {
    let scaled = features.scaled();
    let mut logits = *prior;
    let mut contributions = [[0.0; FEATURES]; 4];
    for ((row, logit), parts) in weights.iter().zip(&mut logits).zip(&mut contributions) {
        *logit += row[FEATURES];
        for ((weight, feature), part) in row.iter().zip(&scaled).zip(parts) {
            *part = weight * feature;
            *logit += *part;
        }
    }
    (logits, contributions)
}
