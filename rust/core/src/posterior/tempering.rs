//! Tempered sequential Monte Carlo (Del Moral, Doucet and Jasra 2006; algorithm C3): weighted samples of one distribution become
//! samples of another over steps that leave enough of them effective; after each they are drawn anew and all moved by Metropolis moves.
//! To move copies alone would not leave the distribution as it is: where they are depends on the weights.
//!
//! What is sampled is a [`Path`]; how, the functions here.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::evidence::Evidence;
use super::memory::filled;
use super::parallel::Course;
use super::resampling::{effective_share, normalise, systematic};
use crate::error::Result;
use crate::math::bisection::last_where_after;
use crate::math::random::Stream;

/// Rounds of bisection for a step of the way: the first one can be as short as a millionth.
const ROUNDS: usize = 20;
/// Numbers of a stream that belong to one sample: those of its moves.
const DRAWS: u64 = 64;
/// The number of a move that decides whether it is accepted; those below it are the proposal's.
const DECISION: u64 = DRAWS - 1;

/// Logarithms of densities at a sample, not normalised.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Logs {
    /// At the start of the way.
    pub start: f64,
    /// What the whole way adds.
    pub added: f64,
}

impl Logs {
    /// At a share of the way.
    pub fn at(&self, share: f64) -> f64 {
        // At the start a density of zero at the end counts for nothing.
        if share == 0.0 {
            self.start
        } else {
            self.start + share * self.added
        }
    }
}

/// A sample is wanted whose logarithm of the density at a share of the way, with that of how many times as likely the way back is
/// proposed, is greater than the least.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Wanted {
    pub share: f64,
    pub least: f64,
}

impl Wanted {
    /// False also where a density is no number.
    pub fn takes(&self, logs: Logs) -> bool {
        logs.at(self.share) > self.least
    }

    /// Where the way back is so many times as likely to be proposed, its logarithm.
    pub fn with_back(self, log_back: f64) -> Self {
        Wanted { least: self.least - log_back, ..self }
    }
}

/// The way from one distribution to another.
pub(crate) trait Path: Sync {
    /// A sample that knows its densities.
    type Sample: Clone + Send + Sync;

    /// The densities at a sample.
    fn logs(&self, sample: &Self::Sample) -> Logs;

    /// Another sample; none where there is none, and it may be none where it is not `wanted`, which saves the work of knowing its
    /// densities. The proposal may depend on the `others` that are about there, and use the random numbers 0 to 62 of the stream from
    /// `first` on, and of streams forked with these numbers.
    fn propose(
        &self,
        sample: &Self::Sample,
        others: &[Self::Sample],
        wanted: Wanted,
        random: &Stream,
        first: u64,
    ) -> Option<Proposal<Self::Sample>>;
}

/// Another sample that is proposed.
#[derive(Debug, Clone)]
pub(crate) struct Proposal<S> {
    pub sample: S,
    /// Logarithm of how many times as likely the way back is proposed (Hastings 1970).
    pub log_back: f64,
}

/// How samples are drawn anew.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tempering {
    /// A step of the way leaves this share of the samples effective, and samples are drawn anew below it.
    pub effective_share: f64,
    /// Moves of each sample each time they are drawn anew.
    pub moves: usize,
    /// Moves of each sample on one way at most: after these it goes to the end, whatever that leaves.
    pub most_moves: usize,
}

/// What a way showed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Travelled {
    /// Logarithm of the normalising constant of the end over that of the start.
    pub log_evidence: f64,
    /// Effective samples in the end, before they are drawn anew.
    pub effective: f64,
    pub steps: usize,
    /// Share of the moves that were accepted; zero where none was tried.
    pub accepted: f64,
}

/// Weighted samples.
#[derive(Debug, Clone)]
pub(crate) struct Samples<S> {
    pub all: Vec<S>,
    /// They sum to one.
    pub weights: Vec<f64>,
    log_weights: Vec<f64>,
    /// Densities at all samples, side by side: they are read many times a step.
    logs: Vec<Logs>,
    evidence: Evidence,
    parents: Vec<u32>,
    spare: Vec<S>,
}

impl<S: Clone + Send + Sync> Samples<S> {
    /// So many, all alike.
    ///
    /// # Errors
    /// [`Error::Memory`](crate::Error::Memory) where there is no space for so many.
    pub fn new(count: usize, first: S) -> Result<Self> {
        Ok(Samples {
            spare: filled(first.clone(), count)?,
            all: filled(first, count)?,
            weights: filled(1.0 / count as f64, count)?,
            log_weights: filled(0.0, count)?,
            logs: filled(Logs { start: 0.0, added: 0.0 }, count)?,
            evidence: Evidence::of(count),
            parents: filled(0, count)?,
        })
    }

    /// As many with equal weights as were set in `all`.
    pub fn restart(&mut self) {
        let count = self.all.len();
        self.log_weights.fill(0.0);
        self.weights.fill(1.0 / count as f64);
        self.evidence = Evidence::of(count);
    }

    /// Takes the samples along a way. A density that is no number is one of zero; where all are zero the samples stay. Once the
    /// course is stopped no sample is moved any more: the weights are right, but fewer samples are effective.
    pub fn travel<P: Path<Sample = S>>(
        &mut self,
        path: &P,
        tempering: Tempering,
        random: Stream,
        course: Course<'_>,
    ) -> Travelled {
        let count = self.all.len();
        let mut travelled = Travelled::default();
        let (mut share, mut left, mut accepted) = (0.0, tempering.most_moves, 0_usize);
        while share < 1.0 {
            travelled.steps += 1;
            let go_on = || left > 0 && !course.stop.load(Ordering::Relaxed);
            self.logs.iter_mut().zip(&self.all).for_each(|(logs, sample)| *logs = path.logs(sample));
            let next = if go_on() { self.next_share(share, tempering.effective_share) } else { 1.0 };
            for (log, logs) in self.log_weights.iter_mut().zip(&self.logs) {
                *log += logs.at(next) - logs.at(share);
            }
            let weighed = normalise(&mut self.log_weights, &mut self.weights, course);
            travelled.log_evidence += self.evidence.take_in(&weighed);
            travelled.effective = weighed.effective;
            share = next;
            let ample = share >= 1.0 && weighed.effective >= tempering.effective_share * count as f64;
            if !ample && go_on() {
                let moves = tempering.moves.min(left);
                let stream = random.fork(travelled.steps as u64);
                accepted += self.draw_anew(path, share, moves, stream, course);
                left -= moves;
            }
        }
        let tried = (tempering.most_moves - left) * count;
        travelled.accepted = if tried > 0 { accepted as f64 / tried as f64 } else { 0.0 };
        travelled
    }

    /// How far the way can be gone at once.
    fn next_share(&self, share: f64, effective: f64) -> f64 {
        let leaves_enough = |next: f64| {
            let weighed = self.log_weights.iter().zip(&self.logs);
            effective_share(weighed.map(|(log, logs)| log + logs.at(next) - logs.at(share))) >= effective
        };
        if leaves_enough(1.0) {
            return 1.0;
        }
        last_where_after(ROUNDS, [share, 1.0], leaves_enough)
    }

    /// Draws samples in proportion to their weights and moves them; how many moves were accepted.
    fn draw_anew<P: Path<Sample = S>>(
        &mut self,
        path: &P,
        share: f64,
        moves: usize,
        random: Stream,
        course: Course<'_>,
    ) -> usize {
        systematic(&self.weights, random.uniform(0), &mut self.parents);
        for (sample, parent) in self.spare.iter_mut().zip(&self.parents) {
            sample.clone_from(&self.all[*parent as usize]);
        }
        self.all.clone_from_slice(&self.spare);
        self.restart();
        let others = &self.spare[..];
        let accepted = AtomicUsize::new(0);
        let stream = random.fork(1);
        let work = |start: usize, samples: &mut [S]| {
            for (k, sample) in samples.iter_mut().enumerate() {
                for turn in 0..moves {
                    let first = ((start + k) * moves + turn) as u64 * DRAWS;
                    let least = path.logs(sample).at(share) + stream.uniform(first + DECISION).ln();
                    let wanted = Wanted { share, least };
                    let other = path.propose(sample, others, wanted, &stream, first);
                    let taken = |other: &Proposal<S>| {
                        wanted.with_back(other.log_back).takes(path.logs(&other.sample))
                    };
                    if let Some(other) = other.filter(taken) {
                        *sample = other.sample;
                        accepted.fetch_add(1, Ordering::Relaxed);
                    }
                }
            }
        };
        course.for_each(&mut self.all[..], 0, &work);
        accepted.into_inner()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use super::*;

    const TEMPERING: Tempering = Tempering { effective_share: 0.5, moves: 4, most_moves: 400 };

    /// From a Gaussian prior to its product with a Gaussian likelihood, in two dimensions.
    struct Gaussian {
        prior: f64,
        measured: [f64; 2],
        noise: [f64; 2],
    }

    impl Path for Gaussian {
        type Sample = [f64; 2];

        fn logs(&self, sample: &[f64; 2]) -> Logs {
            let squared = |k: usize, at: f64, deviation: f64| ((sample[k] - at) / deviation).powi(2);
            let start = -0.5 * (0..2).map(|k| squared(k, 0.0, self.prior)).sum::<f64>();
            let added = -0.5 * (0..2).map(|k| squared(k, self.measured[k], self.noise[k])).sum::<f64>();
            Logs { start, added }
        }

        fn propose(
            &self,
            sample: &[f64; 2],
            _: &[[f64; 2]],
            _: Wanted,
            random: &Stream,
            first: u64,
        ) -> Option<Proposal<[f64; 2]>> {
            let steps = random.normals(first);
            let moved = std::array::from_fn(|k| sample[k] + 1.5 * self.noise[k] * steps[k]);
            Some(Proposal { sample: moved, log_back: 0.0 })
        }
    }

    fn from_prior(count: usize, deviation: f64, seed: u64) -> Samples<[f64; 2]> {
        let mut samples = Samples::new(count, [0.0; 2]).expect("memory");
        let random = Stream::new(seed);
        for (k, sample) in samples.all.iter_mut().enumerate() {
            *sample = random.normals(2 * k as u64).map(|x| deviation * x);
        }
        samples
    }

    fn course(stop: &AtomicBool) -> Course<'_> {
        Course { threads: 1, stop }
    }

    #[test]
    fn mean_covariance_and_normalising_constant_are_those_of_a_gaussian() {
        let path = Gaussian { prior: 3.0, measured: [4.0, -2.0], noise: [0.1, 0.02] };
        let (count, runs, stop) = (4000, 40, AtomicBool::new(false));
        let mut errors = [[0.0; 3]; 2];
        let mut evidence = vec![];
        for seed in 0..runs {
            let mut samples = from_prior(count, path.prior, seed);
            let found = samples.travel(&path, TEMPERING, Stream::new(100 + seed), course(&stop));
            assert!(found.steps > 3 && found.accepted > 0.2, "{found:?}");
            evidence.push(found.log_evidence);
            for k in 0..2 {
                let (prior, noise) = (path.prior.powi(2), path.noise[k].powi(2));
                let variance = prior * noise / (prior + noise);
                let mean = path.measured[k] * variance / noise;
                let of = |f: &dyn Fn(f64) -> f64| -> f64 {
                    samples.all.iter().zip(&samples.weights).map(|(x, w)| w * f(x[k])).sum()
                };
                let own = of(&|x| x);
                errors[k][0] += (own - mean) / variance.sqrt() / runs as f64;
                errors[k][1] += (of(&|x| (x - own).powi(2)) / variance - 1.0) / runs as f64;
                errors[k][2] += of(&|x| ((x - own) / variance.sqrt()).powi(3)) / runs as f64;
            }
        }
        // Monte Carlo errors of 32,000 samples that are not quite independent.
        assert!(
            errors
                .iter()
                .all(|[mean, variance, skew]| mean.abs() < 0.03 && variance.abs() < 0.06 && skew.abs() < 0.1),
            "{errors:?}"
        );
        let exact: f64 = (0..2)
            .map(|k| {
                let sum = path.prior.powi(2) + path.noise[k].powi(2);
                0.5 * (path.noise[k].powi(2) / sum).ln() - 0.5 * path.measured[k].powi(2) / sum
            })
            .sum();
        // Its estimate has no bias, the logarithm of it has.
        let ratios: Vec<f64> = evidence.iter().map(|log| (log - exact).exp()).collect();
        let mean = ratios.iter().sum::<f64>() / runs as f64;
        let variance = ratios.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (runs - 1) as f64;
        let error = (variance / runs as f64).sqrt();
        assert!((mean - 1.0).abs() < 3.0 * error && error < 0.1, "{mean} {error}");
    }

    #[test]
    fn densities_of_zero_and_none_are_left_behind() {
        struct Half;
        impl Path for Half {
            type Sample = f64;
            fn logs(&self, sample: &f64) -> Logs {
                let added = if *sample > 0.5 {
                    f64::NEG_INFINITY
                } else if *sample < -0.5 {
                    f64::NAN
                } else {
                    0.0
                };
                Logs { start: 0.0, added }
            }
            fn propose(
                &self,
                sample: &f64,
                _: &[f64],
                _: Wanted,
                random: &Stream,
                first: u64,
            ) -> Option<Proposal<f64>> {
                let moved =
                    || Proposal { sample: sample + 0.1 * random.normals(first + 1)[0], log_back: 0.0 };
                (random.uniform(first) < 0.9).then(moved)
            }
        }
        let stop = AtomicBool::new(false);
        let mut samples = Samples::new(1000, 0.0).expect("memory");
        let random = Stream::new(5);
        samples.all.iter_mut().enumerate().for_each(|(k, x)| *x = 2.0 * random.uniform(k as u64) - 1.0);
        let found = samples.travel(&Half, TEMPERING, Stream::new(1), course(&stop));
        let kept = samples.all.iter().zip(&samples.weights).filter(|(_, weight)| **weight > 0.0);
        assert!(kept.map(|(x, _)| x).all(|x| x.abs() <= 0.5));
        assert!((found.log_evidence - 0.5f64.ln()).abs() < 0.1, "{found:?}");
    }

    #[test]
    fn one_sample_stays_one_and_none_that_fits_leaves_them() {
        let path = Gaussian { prior: 1.0, measured: [0.5, 0.5], noise: [0.1, 0.1] };
        let stop = AtomicBool::new(false);
        let mut one = from_prior(1, 1.0, 3);
        let found = one.travel(&path, TEMPERING, Stream::new(1), course(&stop));
        assert!(one.weights == [1.0] && found.log_evidence.is_finite() && found.effective == 1.0);
        struct Nowhere;
        impl Path for Nowhere {
            type Sample = [f64; 2];
            fn logs(&self, _: &[f64; 2]) -> Logs {
                Logs { start: 0.0, added: f64::NEG_INFINITY }
            }
            fn propose(
                &self,
                _: &[f64; 2],
                _: &[[f64; 2]],
                _: Wanted,
                _: &Stream,
                _: u64,
            ) -> Option<Proposal<[f64; 2]>> {
                None
            }
        }
        let mut some = from_prior(50, 1.0, 3);
        let found = some.travel(&Nowhere, TEMPERING, Stream::new(1), course(&stop));
        assert_eq!(found.log_evidence, f64::NEG_INFINITY);
        assert!(some.weights.iter().all(|weight| (weight - 0.02).abs() < 1e-12));
    }

    #[test]
    #[cfg(feature = "parallel")]
    fn answers_are_the_same_on_any_number_of_threads() {
        use crate::posterior::parallel::Pool;
        let path = Gaussian { prior: 3.0, measured: [4.0, -2.0], noise: [0.1, 0.02] };
        let stop = AtomicBool::new(false);
        let run = |threads: usize| {
            let pool = Pool::new(threads).expect("threads");
            let mut samples = from_prior(3000, path.prior, 1);
            let mut found = Travelled::default();
            pool.install(|| {
                found = samples.travel(&path, TEMPERING, Stream::new(9), Course { threads, stop: &stop })
            });
            (samples.all, samples.weights, found)
        };
        let (one, three) = (run(1), run(3));
        assert!(one == three);
    }
}
