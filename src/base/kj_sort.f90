!> Sorting and looking up of user ids.
module kj_sort
   use kj_kinds, only: wp
   implicit none
   private

   public :: lookup_t, new_lookup, find, lower_bound, sorted_order, sort_unique, find_root

   !> Ids in ascending order and where each stood
   type :: lookup_t
      integer, allocatable :: id(:)       !! ascending
      integer, allocatable :: place(:)    !! place of id(i) in the list it was made from
   end type lookup_t

contains

   !> Stable order that sorts the keys ascending (merge sort): keys(order) ascends
   pure function sorted_order(keys) result(order)
      integer, intent(in) :: keys(:)
      integer, allocatable :: order(:)

      integer, allocatable :: other(:)
      integer :: n, width, lo, mid, hi, i, j, k

      n = size(keys)
      order = [(i, i=1, n)]
      if (all(keys(2:) >= keys(:max(0, n - 1)))) return
      allocate (other(n))
      width = 1
      do while (width < n)
         do lo = 1, n, 2*width
            mid = min(lo + width - 1, n)
            hi = min(lo + 2*width - 1, n)
            i = lo
            j = mid + 1
            do k = lo, hi
               if (j > hi) then
                  other(k) = order(i)
                  i = i + 1
               else if (i > mid) then
                  other(k) = order(j)
                  j = j + 1
               else if (keys(order(j)) < keys(order(i))) then
                  other(k) = order(j)
                  j = j + 1
               else
                  other(k) = order(i)
                  i = i + 1
               end if
            end do
         end do
         call swap(order, other)
         width = 2*width
      end do
   contains
      pure subroutine swap(a, b)
         integer, allocatable, intent(inout) :: a(:), b(:)

         integer, allocatable :: keep(:)

         call move_alloc(a, keep)
         call move_alloc(b, a)
         call move_alloc(keep, b)
      end subroutine swap
   end function sorted_order

   !> The keys in ascending order without repeats
   pure function sort_unique(keys) result(list)
      integer, intent(in) :: keys(:)
      integer, allocatable :: list(:)

      logical, allocatable :: first(:)

      list = keys(sorted_order(keys))
      allocate (first(size(list)), source=.true.)
      if (size(list) > 1) first(2:) = list(2:) /= list(:size(list) - 1)
      list = pack(list, first)
   end function sort_unique

   !> Make the lookup of a list of ids
   pure subroutine new_lookup(ids, lookup)
      integer, intent(in) :: ids(:)
      type(lookup_t), intent(out) :: lookup

      lookup%place = sorted_order(ids)
      lookup%id = ids(lookup%place)
   end subroutine new_lookup

   !> Place of an id (the first of equals), 0 when there is none
   pure integer function find(lookup, id) result(place)
      type(lookup_t), intent(in) :: lookup
      integer, intent(in) :: id

      integer :: i, k, lo, hi

      place = 0
      lo = 1
      hi = size(lookup%id)
      do k = 1, 3                         ! guess: ids mostly follow each other
         if (lo > hi) return
         if (id < lookup%id(lo) .or. id > lookup%id(hi)) return
         if (lo == hi) exit
         i = lo + int((real(id, wp) - lookup%id(lo))*real(hi - lo, wp)/ &
            max(1.0_wp, real(lookup%id(hi), wp) - lookup%id(lo)))
         if (lookup%id(i) < id) then
            lo = i + 1
         else
            hi = i
            if (i == lo) cycle
            if (lookup%id(i - 1) < id) lo = i
            if (lookup%id(i - 1) >= id) hi = i - 1
         end if
      end do
      if (lo < hi) lo = lo - 1 + lower_bound(lookup%id(lo:hi), id)
      if (lookup%id(lo) == id) place = lookup%place(lo)
   end function find

   !> First place whose key is not below this one, size(keys) + 1 when all are
   pure integer function lower_bound(keys, key) result(lo)
      integer, intent(in) :: keys(:)      !! ascending
      integer, intent(in) :: key

      integer :: hi, middle

      lo = 1
      hi = size(keys) + 1
      do while (lo < hi)
         middle = (lo + hi)/2
         if (keys(middle) < key) then
            lo = middle + 1
         else
            hi = middle
         end if
      end do
   end function lower_bound

   !> Root of a lead, or of anything in trees of parents; halves the way there for the next time
   pure subroutine find_root(lead, parent, root)
      integer, intent(in) :: lead
      integer, intent(inout) :: parent(:)
      integer, intent(out) :: root

      root = lead
      do while (parent(root) /= root)
         parent(root) = parent(parent(root))
         root = parent(root)
      end do
   end subroutine find_root

end module kj_sort
