//! Eight numbers at a time: by AVX2 where the processor has it, else by arrays.
//!
//! Both do the same operations in the same order, each rounded by IEEE 754 and none fused, so that what a ray meets does not
//! depend on the processor.

/// Numbers in a vector.
pub(crate) const WIDTH: usize = 8;

/// What a vector unit can do. A value of it is proof that the processor has one.
pub(crate) trait Lanes: Copy {
    /// Eight numbers.
    type F: Copy;
    /// Eight truths.
    type M: Copy;
    /// Eight sets of 32.
    type U: Copy;

    fn load(self, a: &[f32; WIDTH]) -> Self::F;
    fn store(self, a: Self::F) -> [f32; WIDTH];
    fn splat(self, x: f32) -> Self::F;
    fn add(self, a: Self::F, b: Self::F) -> Self::F;
    fn sub(self, a: Self::F, b: Self::F) -> Self::F;
    fn mul(self, a: Self::F, b: Self::F) -> Self::F;
    fn div(self, a: Self::F, b: Self::F) -> Self::F;
    /// a < b ? a : b, and so `b` if either is NaN.
    fn min(self, a: Self::F, b: Self::F) -> Self::F;
    /// a > b ? a : b, and so `b` if either is NaN.
    fn max(self, a: Self::F, b: Self::F) -> Self::F;
    fn lt(self, a: Self::F, b: Self::F) -> Self::M;
    fn le(self, a: Self::F, b: Self::F) -> Self::M;
    fn eq(self, a: Self::F, b: Self::F) -> Self::M;
    fn and(self, a: Self::M, b: Self::M) -> Self::M;
    fn or(self, a: Self::M, b: Self::M) -> Self::M;
    /// Bit k is the truth of lane k.
    fn bits(self, a: Self::M) -> u32;
    /// Eight sets of 32, empty.
    fn no_sets(self) -> Self::U;
    /// Puts `member` (one bit) into the sets of the lanes that are true.
    fn put(self, sets: Self::U, lanes: Self::M, member: u32) -> Self::U;
    fn sets(self, sets: Self::U) -> [u32; WIDTH];
    /// Does the task in code that is compiled for this unit.
    fn run<T: Task>(self, task: T) -> T::Output;
}

/// Something to do by any vector unit.
pub(crate) trait Task {
    type Output;
    /// Mark it `#[inline(always)]`, and all that it calls: what is not inlined is not compiled for the unit.
    fn run<L: Lanes>(self, lanes: L) -> Self::Output;
}

/// Arrays, as the compiler likes them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Portable;

#[inline(always)]
fn map<A: Copy, B: Copy, C>(a: [A; WIDTH], b: [B; WIDTH], f: impl Fn(A, B) -> C) -> [C; WIDTH] {
    std::array::from_fn(|k| f(a[k], b[k]))
}

impl Lanes for Portable {
    type F = [f32; WIDTH];
    type M = [bool; WIDTH];
    type U = [u32; WIDTH];

    #[inline(always)]
    fn load(self, a: &[f32; WIDTH]) -> Self::F {
        *a
    }
    #[inline(always)]
    fn store(self, a: Self::F) -> [f32; WIDTH] {
        a
    }
    #[inline(always)]
    fn splat(self, x: f32) -> Self::F {
        [x; WIDTH]
    }
    #[inline(always)]
    fn add(self, a: Self::F, b: Self::F) -> Self::F {
        map(a, b, |a, b| a + b)
    }
    #[inline(always)]
    fn sub(self, a: Self::F, b: Self::F) -> Self::F {
        map(a, b, |a, b| a - b)
    }
    #[inline(always)]
    fn mul(self, a: Self::F, b: Self::F) -> Self::F {
        map(a, b, |a, b| a * b)
    }
    #[inline(always)]
    fn div(self, a: Self::F, b: Self::F) -> Self::F {
        map(a, b, |a, b| a / b)
    }
    #[inline(always)]
    fn min(self, a: Self::F, b: Self::F) -> Self::F {
        map(a, b, |a, b| if a < b { a } else { b })
    }
    #[inline(always)]
    fn max(self, a: Self::F, b: Self::F) -> Self::F {
        map(a, b, |a, b| if a > b { a } else { b })
    }
    #[inline(always)]
    fn lt(self, a: Self::F, b: Self::F) -> Self::M {
        map(a, b, |a, b| a < b)
    }
    #[inline(always)]
    fn le(self, a: Self::F, b: Self::F) -> Self::M {
        map(a, b, |a, b| a <= b)
    }
    #[inline(always)]
    fn eq(self, a: Self::F, b: Self::F) -> Self::M {
        map(a, b, |a, b| a == b)
    }
    #[inline(always)]
    fn and(self, a: Self::M, b: Self::M) -> Self::M {
        map(a, b, |a, b| a & b)
    }
    #[inline(always)]
    fn or(self, a: Self::M, b: Self::M) -> Self::M {
        map(a, b, |a, b| a | b)
    }
    #[inline(always)]
    fn bits(self, a: Self::M) -> u32 {
        (0..WIDTH).fold(0, |bits, k| bits | (a[k] as u32) << k)
    }
    #[inline(always)]
    fn no_sets(self) -> Self::U {
        [0; WIDTH]
    }
    #[inline(always)]
    fn put(self, sets: Self::U, lanes: Self::M, member: u32) -> Self::U {
        map(sets, lanes, |s, m| if m { s | member } else { s })
    }
    #[inline(always)]
    fn sets(self, sets: Self::U) -> [u32; WIDTH] {
        sets
    }
    #[inline(always)]
    fn run<T: Task>(self, task: T) -> T::Output {
        task.run(self)
    }
}
