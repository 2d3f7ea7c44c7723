//! Which contact of one hypothesis is which of another: contacts have no order of their own.

use nalgebra::Vector3;

/// Contacts farther apart than this are other contacts, however far (m).
const APART: f64 = 0.2;
/// A contact that was there before is taken to be where it was until all hypotheses have it within so much, its standard deviation (m).
const SETTLED: f64 = 0.05;
/// Rounds of ordering hypotheses by where contacts are on average, and averaging.
const ROUNDS: usize = 2;

/// Keeps the contacts of all hypotheses in the same order from update to update.
#[derive(Debug, Clone, Copy)]
pub(super) struct Orders<const N: usize> {
    /// Where each contact is on average; none where it was not there before.
    centres: [Option<Vector3<f64>>; N],
}

impl<const N: usize> Orders<N> {
    /// Contacts of which the first are where others were before, as far as there are as many.
    pub fn after(before: &[Vector3<f64>]) -> Self {
        Orders { centres: std::array::from_fn(|k| before.get(k).copied()) }
    }

    /// Puts the contacts of weighted hypotheses in order, by their points.
    pub fn settle<H>(
        &mut self,
        hypotheses: &mut [H],
        weights: &[f64],
        points: impl Fn(&H) -> [Vector3<f64>; N],
        reorder: impl Fn(&mut H, &[usize; N]),
    ) {
        let heaviest = weights.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
        let Some(likely) = heaviest.map(|(k, _)| points(&hypotheses[k])) else { return };
        let order = nearest_order(&likely, &self.centres);
        let mut centres: [_; N] = std::array::from_fn(|k| Some(self.centres[k].unwrap_or(likely[order[k]])));
        for _ in 0..ROUNDS {
            let mut sums = [(Vector3::zeros(), 0.0); N];
            for (hypothesis, weight) in hypotheses.iter_mut().zip(weights) {
                let order = nearest_order(&points(hypothesis), &centres);
                if order != std::array::from_fn(|k| k) {
                    reorder(hypothesis, &order);
                }
                for ((sum, squares), point) in sums.iter_mut().zip(points(hypothesis)) {
                    *sum += point * *weight;
                    *squares += point.norm_squared() * weight;
                }
            }
            for (k, (mean, squares)) in sums.into_iter().enumerate() {
                let settled = squares - mean.norm_squared() < SETTLED * SETTLED;
                if settled || self.centres[k].is_none() {
                    centres[k] = Some(mean);
                }
            }
        }
        self.centres = centres;
    }
}

/// The order of points in which they are nearest to the centres, as far as these are known.
fn nearest_order<const N: usize>(
    points: &[Vector3<f64>; N],
    centres: &[Option<Vector3<f64>>; N],
) -> [usize; N] {
    let far: [[f64; N]; N] = centres.map(|centre| {
        points.map(|point| {
            centre.map_or(APART * APART, |centre| (point - centre).norm_squared().min(APART * APART))
        })
    });
    let mut order = std::array::from_fn(|k| k);
    let mut best = (f64::INFINITY, order);
    permute(&mut order, 0, &mut |order| {
        let sum = order.iter().enumerate().map(|(k, point)| far[k][*point]).sum();
        if sum < best.0 {
            best = (sum, *order);
        }
    });
    best.1
}

fn permute<const N: usize>(order: &mut [usize; N], from: usize, each: &mut impl FnMut(&[usize; N])) {
    if from + 1 >= N {
        each(order);
        return;
    }
    for k in from..N {
        order.swap(from, k);
        permute(order, from + 1, each);
        order.swap(from, k);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contacts_come_into_the_order_of_those_before() {
        let at = |x: f64| Vector3::new(x, 0.0, 0.0);
        let mut hypotheses =
            [[at(0.0), at(1.0), at(2.0)], [at(2.1), at(0.1), at(1.1)], [at(1.0), at(1.9), at(0.2)]];
        let mut orders = Orders::after(&[]);
        let reorder = |points: &mut [Vector3<f64>; 3], order: &[usize; 3]| *points = order.map(|k| points[k]);
        orders.settle(&mut hypotheses, &[0.5, 0.3, 0.2], |points| *points, reorder);
        for points in &hypotheses {
            assert!(points[0].x < 0.5 && points[2].x > 1.5, "{points:?}");
        }
        // The heaviest is another one now: the order stays.
        let mut turned = [[at(2.0), at(1.0), at(0.0)]; 3];
        orders.settle(&mut turned, &[0.1, 0.1, 0.8], |points| *points, reorder);
        assert_eq!(turned[2].map(|point| point.x), [0.0, 1.0, 2.0]);
        // One that was there before stays the first beside others.
        let mut orders = Orders::after(&[at(1.02)]);
        let mut more = [[at(0.0), at(1.0), at(2.0)]];
        orders.settle(&mut more, &[1.0], |points| *points, reorder);
        assert_eq!(more[0][0].x, 1.0);
    }
}
