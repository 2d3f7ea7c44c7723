//! The time between rows from positions and velocities.

/// Rows over which positions are compared with velocities: noise of single rows then matters little.
const STRIDES: usize = 400;

/// Of angles and velocities `(n, nv)`: how many units of time a row takes (of `time`, else of one a row), and the share of the motion that this explains.
pub(super) fn time_scale(nv: usize, angle: &[f64], v: &[f64], time: Option<&[f64]>) -> (f64, f64) {
    let n = v.len() / nv.max(1);
    let stride = (n / STRIDES).max(1);
    if n < 3 {
        return (0.0, 0.0);
    }
    let mut pairs: Vec<(f64, f64)> = vec![];
    for k in 0..nv {
        let mut of_joint = vec![];
        for start in (0..n - stride).step_by(stride) {
            let way: f64 = (start..start + stride)
                .map(|row| {
                    let step = time.map_or(1.0, |time| time[row + 1] - time[row]);
                    0.5 * step * (v[row * nv + k] + v[(row + 1) * nv + k])
                })
                .sum();
            of_joint.push((angle[(start + stride) * nv + k] - angle[start * nv + k], way));
        }
        let size = (of_joint.iter().map(|pair| pair.0 * pair.0).sum::<f64>() / of_joint.len() as f64).sqrt();
        if size > 1e-9 {
            pairs.extend(of_joint.iter().map(|(dq, way)| (dq / size, way / size)));
        }
    }
    slope(&pairs)
}

/// The slope of a line through zero that a few outliers do not turn, and the share of the rest that it explains.
fn slope(pairs: &[(f64, f64)]) -> (f64, f64) {
    let mut kept: Vec<(f64, f64)> = pairs.to_vec();
    let mut slope = 0.0;
    let mut share = 0.0;
    for _ in 0..4 {
        let (mut xy, mut xx, mut yy) = (0.0, 0.0, 0.0);
        for (y, x) in &kept {
            xy += x * y;
            xx += x * x;
            yy += y * y;
        }
        if xx <= 0.0 || yy <= 0.0 {
            return (0.0, 0.0);
        }
        slope = xy / xx;
        share = xy * xy / (xx * yy);
        let mut misfits: Vec<f64> = pairs.iter().map(|(y, x)| (y - slope * x).abs()).collect();
        misfits.sort_by(f64::total_cmp);
        // The worst tenth may be gaps.
        let limit = 2.0 * misfits[misfits.len() * 9 / 10] + 1e-12;
        kept = pairs.iter().copied().filter(|(y, x)| (y - slope * x).abs() <= limit).collect();
    }
    (slope, share)
}
