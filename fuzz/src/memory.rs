//! Memory of this process, counted at every allocation.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// An input that takes more than this is a fault \[bytes\].
pub const LARGEST: usize = 2 << 30;

static NOW: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);

/// The system's allocator with a count.
struct Counting;

#[global_allocator]
static ALLOCATOR: Counting = Counting;

// The only way to see every allocation of the process. Each call goes to the system's allocator
// with the arguments it came with, so its promises are the system's; the counts are atomic.
// Over LARGEST it answers null as a full machine does: the process ends instead of the machine.
#[allow(unsafe_code, reason = "an allocator is unsafe to implement; argued above")]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        if !take(layout.size()) {
            return std::ptr::null_mut();
        }
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        if !take(layout.size()) {
            return std::ptr::null_mut();
        }
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        NOW.fetch_sub(layout.size(), Relaxed);
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        if !take(size) {
            return std::ptr::null_mut();
        }
        NOW.fetch_sub(layout.size(), Relaxed);
        unsafe { System.realloc(pointer, layout, size) }
    }
}

/// Counts `size` more bytes; false where they are too many.
fn take(size: usize) -> bool {
    let now = NOW.fetch_add(size, Relaxed) + size;
    if now > LARGEST {
        NOW.fetch_sub(size, Relaxed);
        return false;
    }
    if now > PEAK.load(Relaxed) {
        PEAK.store(now, Relaxed);
    }
    true
}

/// Begins a measurement; gives what is held now.
pub fn begin() -> usize {
    let now = NOW.load(Relaxed);
    PEAK.store(now, Relaxed);
    now
}

/// Most that was held since [`begin`] beyond what was held then.
pub fn peak_since(begin: usize) -> usize {
    PEAK.load(Relaxed).saturating_sub(begin)
}
