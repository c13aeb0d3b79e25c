//! Lanes of AVX2, through the safe tokens of `pulp`: a `V3` exists only where the processor was seen to have it.

use super::lanes::{Lanes, Task, WIDTH};
use pulp::NullaryFnOnce;
use pulp::x86::V3;
use std::arch::x86_64::{__m256, _CMP_EQ_OQ, _CMP_LE_OQ, _CMP_LT_OQ};

/// AVX2. No fused operation, else results would differ from `Portable`'s.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx2(V3);

impl Avx2 {
    /// `None` where the processor has it not.
    pub fn detect() -> Option<Self> {
        V3::try_new().map(Avx2)
    }
}

impl Lanes for Avx2 {
    type F = __m256;
    type M = __m256;
    type U = __m256;

    #[inline(always)]
    fn load(self, a: &[f32; WIDTH]) -> __m256 {
        pulp::cast(*a)
    }
    #[inline(always)]
    fn store(self, a: __m256) -> [f32; WIDTH] {
        pulp::cast(a)
    }
    #[inline(always)]
    fn splat(self, x: f32) -> __m256 {
        self.0.avx._mm256_set1_ps(x)
    }
    #[inline(always)]
    fn add(self, a: __m256, b: __m256) -> __m256 {
        self.0.avx._mm256_add_ps(a, b)
    }
    #[inline(always)]
    fn sub(self, a: __m256, b: __m256) -> __m256 {
        self.0.avx._mm256_sub_ps(a, b)
    }
    #[inline(always)]
    fn mul(self, a: __m256, b: __m256) -> __m256 {
        self.0.avx._mm256_mul_ps(a, b)
    }
    #[inline(always)]
    fn div(self, a: __m256, b: __m256) -> __m256 {
        self.0.avx._mm256_div_ps(a, b)
    }
    #[inline(always)]
    fn min(self, a: __m256, b: __m256) -> __m256 {
        self.0.avx._mm256_min_ps(a, b)
    }
    #[inline(always)]
    fn max(self, a: __m256, b: __m256) -> __m256 {
        self.0.avx._mm256_max_ps(a, b)
    }
    #[inline(always)]
    fn lt(self, a: __m256, b: __m256) -> __m256 {
        self.0.avx._mm256_cmp_ps::<_CMP_LT_OQ>(a, b)
    }
    #[inline(always)]
    fn le(self, a: __m256, b: __m256) -> __m256 {
        self.0.avx._mm256_cmp_ps::<_CMP_LE_OQ>(a, b)
    }
    #[inline(always)]
    fn eq(self, a: __m256, b: __m256) -> __m256 {
        self.0.avx._mm256_cmp_ps::<_CMP_EQ_OQ>(a, b)
    }
    #[inline(always)]
    fn and(self, a: __m256, b: __m256) -> __m256 {
        self.0.avx._mm256_and_ps(a, b)
    }
    #[inline(always)]
    fn or(self, a: __m256, b: __m256) -> __m256 {
        self.0.avx._mm256_or_ps(a, b)
    }
    #[inline(always)]
    fn bits(self, a: __m256) -> u32 {
        self.0.avx._mm256_movemask_ps(a) as u32
    }
    #[inline(always)]
    fn no_sets(self) -> __m256 {
        self.0.avx._mm256_setzero_ps()
    }
    #[inline(always)]
    fn put(self, sets: __m256, lanes: __m256, member: u32) -> __m256 {
        // Bits of no number: nothing but and, or is done with them.
        let member = self.0.avx._mm256_castsi256_ps(self.0.avx._mm256_set1_epi32(member as i32));
        self.0.avx._mm256_or_ps(sets, self.0.avx._mm256_and_ps(lanes, member))
    }
    #[inline(always)]
    fn sets(self, sets: __m256) -> [u32; WIDTH] {
        pulp::cast(sets)
    }
    #[inline(always)]
    fn run<T: Task>(self, task: T) -> T::Output {
        self.0.vectorize(Within(self, task))
    }
}

/// A task to be called where the compiler may use AVX2.
struct Within<T>(Avx2, T);
impl<T: Task> NullaryFnOnce for Within<T> {
    type Output = T::Output;
    #[inline(always)]
    fn call(self) -> T::Output {
        self.1.run(self.0)
    }
}
