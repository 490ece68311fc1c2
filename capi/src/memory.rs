//! The caller's memory: checked where it can be checked, copied, and written last.

use super::status::{
    Fault, ISYM_ERROR_ALIGNMENT, ISYM_ERROR_LENGTH, ISYM_ERROR_NULL, ISYM_ERROR_SIZE, ISYM_ERROR_TEXT, Result,
};
use std::ffi::{CStr, c_char};
use std::mem::MaybeUninit;

/// Refuses a NULL, a pointer that is not aligned, and a length that no array can have.
fn check<T>(pointer: *const T, length: usize, name: &str) -> Result {
    if pointer.is_null() {
        return Err(Fault::new(ISYM_ERROR_NULL, format!("{name} is NULL")));
    }
    if !pointer.is_aligned() {
        let needed = align_of::<T>();
        return Err(Fault::new(ISYM_ERROR_ALIGNMENT, format!("{name} is not aligned to {needed} bytes")));
    }
    if length.checked_mul(size_of::<T>()).is_none_or(|bytes| bytes > isize::MAX as usize) {
        return Err(Fault::new(ISYM_ERROR_LENGTH, format!("{name}: no array has {length} elements")));
    }
    Ok(())
}

/// A copy of the caller's array.
///
/// # Safety
/// `length` elements can be read at `pointer`, unless it is NULL or not aligned, which is refused.
pub unsafe fn array<T: Copy>(pointer: *const T, length: usize, name: &str) -> Result<Vec<T>> {
    check(pointer, length, name)?;
    // SAFETY: not NULL, aligned, of a possible size; readable by this function's own condition.
    Ok(unsafe { std::slice::from_raw_parts(pointer, length) }.to_vec())
}

/// A struct of the header. Its first field is its `size` as the caller's compiler knows it, so that later versions can append
/// fields, and tell from the size which ones the caller has. Each version must be longer than the one before: a field that only
/// fills the padding at the end needs another one beside it.
///
/// # Safety
/// The struct is `repr(C)`, and its first field is a `usize`.
pub unsafe trait Versioned: Copy {}

/// Refuses a struct of another size. Only its first field is read.
///
/// # Safety
/// A `usize` can be read at `pointer`, unless it is NULL or not aligned, which is refused.
unsafe fn check_size<T: Versioned>(pointer: *const T, name: &str) -> Result {
    check(pointer, 1, name)?;
    // SAFETY: not NULL and aligned; a `usize` is first by the trait's condition, and readable by this function's own.
    let (found, needed) = (unsafe { pointer.cast::<usize>().read() }, size_of::<T>());
    if found == needed {
        return Ok(());
    }
    let message = format!(
        "{name}: its size is {found}, this library's is {needed}; set size to sizeof before the call"
    );
    Err(Fault::new(ISYM_ERROR_SIZE, message))
}

/// A copy of the caller's struct.
///
/// # Safety
/// `pointer` is NULL, or points to as many bytes as its first field says, and to that field at least.
pub unsafe fn structure<T: Versioned>(pointer: *const T, name: &str) -> Result<T> {
    // SAFETY: this function's own condition, twice.
    unsafe {
        check_size(pointer, name)?;
        Ok(pointer.read())
    }
}

/// The number in an enumeration of the caller's, which need not be one of its constants: such a value must not become a Rust `enum`.
///
/// # Safety
/// `Enumeration` is `repr(i32)`, and `value` is initialized.
pub unsafe fn number<Enumeration>(value: MaybeUninit<Enumeration>) -> i32 {
    const { assert!(size_of::<Enumeration>() == size_of::<i32>()) }
    // SAFETY: of this size by the line above, initialized by this function's own condition.
    unsafe { value.as_ptr().cast::<i32>().read() }
}

/// A copy of the caller's text.
///
/// # Safety
/// `pointer` is NULL or points to a text that ends in a NUL.
pub unsafe fn text(pointer: *const c_char, name: &str) -> Result<String> {
    check(pointer, 1, name)?;
    // SAFETY: not NULL; the text ends by this function's own condition.
    let text = unsafe { CStr::from_ptr(pointer) };
    let text = text.to_str().map_err(|_| Fault::new(ISYM_ERROR_TEXT, format!("{name} is not UTF-8")))?;
    Ok(text.to_string())
}

/// An array of the caller's that will be written, whole and last.
pub struct Output<T> {
    pointer: *mut T,
    length: usize,
    name: &'static str,
}

impl<T: Copy> Output<T> {
    /// # Safety
    /// `length` elements can be written at `pointer` until the call returns, unless it is NULL or not
    /// aligned, which is refused.
    pub unsafe fn new(pointer: *mut T, length: usize, name: &'static str) -> Result<Output<T>> {
        check(pointer, length, name)?;
        Ok(Output { pointer, length, name })
    }

    /// As [`Output::new`], for one struct, whose size the caller has set.
    ///
    /// # Safety
    /// `pointer` is NULL, or points to as many writable bytes as its first field says, and to that field at least.
    pub unsafe fn structure(pointer: *mut T, name: &'static str) -> Result<Output<T>>
    where
        T: Versioned,
    {
        // SAFETY: this function's own condition, twice.
        unsafe {
            check_size(pointer, name)?;
            Output::new(pointer, 1, name)
        }
    }

    /// Refuses an output of another length than `needed`.
    pub fn expect(self, needed: usize) -> Result<Output<T>> {
        expect(self.length, needed, self.name)?;
        Ok(self)
    }

    /// Writes all elements. It may be memory that was also an input.
    ///
    /// # Panics
    /// If there are more or fewer values than elements.
    pub fn write(self, values: &[T]) {
        assert_eq!(values.len(), self.length);
        // SAFETY: writable for `length` elements by the condition of `new`; `values` is memory of ours.
        unsafe { std::ptr::copy_nonoverlapping(values.as_ptr(), self.pointer, self.length) }
    }
}

/// Refuses a length other than `needed`.
pub fn expect(found: usize, needed: usize, name: &str) -> Result {
    if found == needed {
        return Ok(());
    }
    Err(Fault::new(ISYM_ERROR_LENGTH, format!("{name} has {found} elements, {needed} are needed")))
}

/// `a * b`, or a fault: a length that no array has.
pub fn product(a: usize, b: usize) -> Result<usize> {
    a.checked_mul(b).ok_or_else(|| Fault::new(ISYM_ERROR_LENGTH, format!("no array has {a} x {b} elements")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn null_unaligned_and_impossible_arrays_are_refused() {
        let values = [1.0f64, 2.0];
        let read = |pointer: *const f64, length| {
            // SAFETY: what is not refused is `values`.
            unsafe { array(pointer, length, "positions") }.map_err(|fault| fault.status)
        };
        assert_eq!(read(values.as_ptr(), 2), Ok(values.to_vec()));
        assert_eq!(read(std::ptr::null(), 2), Err(ISYM_ERROR_NULL));
        assert_eq!(read(values.as_ptr().wrapping_byte_add(1), 1), Err(ISYM_ERROR_ALIGNMENT));
        assert_eq!(read(values.as_ptr(), usize::MAX), Err(ISYM_ERROR_LENGTH));
        assert_eq!(product(usize::MAX, 3).unwrap_err().status, ISYM_ERROR_LENGTH);
    }

    #[repr(C)]
    #[derive(Debug, Clone, Copy, PartialEq)]
    struct Pair {
        size: usize,
        number: u32,
    }

    // SAFETY: as declared above.
    unsafe impl Versioned for Pair {}

    #[test]
    fn a_struct_of_another_size_is_refused_and_untouched() {
        for size in [0, 8, 24, usize::MAX] {
            let mut pair = Pair { size, number: 7 };
            // SAFETY: a pair.
            let (read, write) = unsafe { (structure(&pair, "pair"), Output::structure(&mut pair, "pair")) };
            assert_eq!(read.unwrap_err().status, ISYM_ERROR_SIZE);
            assert_eq!(write.map(|_| ()).unwrap_err().status, ISYM_ERROR_SIZE);
            assert_eq!(pair, Pair { size, number: 7 });
        }
        let pair = Pair { size: size_of::<Pair>(), number: 7 };
        // SAFETY: a pair.
        assert_eq!(unsafe { structure(&pair, "pair") }, Ok(pair));
        // SAFETY: NULL is refused.
        assert_eq!(
            unsafe { structure::<Pair>(std::ptr::null(), "pair") }.unwrap_err().status,
            ISYM_ERROR_NULL
        );
    }

    #[test]
    fn an_output_of_another_length_is_refused_and_untouched() {
        let mut values = [7u32; 3];
        // SAFETY: three elements.
        let output = unsafe { Output::new(values.as_mut_ptr(), 3, "partner") }.unwrap();
        let fault = output.expect(4).map(|_| ()).unwrap_err();
        assert_eq!(fault.message, "partner has 3 elements, 4 are needed");
        assert_eq!(values, [7; 3]);
    }
}
