!> What the C functions share: handles, texts, structures. include/kjoint.h says what they mean.
module kjoint_c_base
   use, intrinsic :: iso_c_binding, only: c_ptr, c_char, c_int, c_size_t, c_double, c_f_pointer, &
      c_loc, c_associated, c_null_char, c_null_ptr
   use kj_error, only: error_t, finding_list_t, str, ERR_INPUT, SEV_NOTE, SEV_ERROR
   use kj_host, only: joint_set_t, joint_result_t
   use kj_sink, only: sink_memory_t
   use kjoint, only: simulation_t, run_status_t
   implicit none
   private

   public :: box_t, entered, has_room, hand_out, release, outcome, refuse, put_text, &
      put_count, list_findings
   public :: c_joint_result_t, c_joint_result

   integer, parameter, public :: OK = 0
   integer, parameter, public :: OF_JOINTS = 1263157841, OF_MODEL = 1263157842

   !> What a kj_joints or kj_model handle points to
   type :: box_t
      integer :: mark = 0                        !! OF_JOINTS or OF_MODEL
      character(len=:), allocatable :: message
      type(joint_set_t) :: set                   !! OF_JOINTS; what follows OF_MODEL
      type(simulation_t) :: sim
      type(sink_memory_t) :: samples
      type(run_status_t) :: status
      logical :: stepping = .false.              !! the status is that of the scene
      logical :: running = .false.               !! kj_model_run has it
      type(finding_list_t) :: findings
   end type box_t

   !> kj_joint_result
   type, bind(c) :: c_joint_result_t
      integer(c_int) :: id, type
      real(c_double) :: force(6), displacement(6), frame(3, 3), energy, dissipated, orthogonality
   end type c_joint_result_t

contains

   !> Begin a call: the box behind a handle. The call ends at once, with the status, when there is
   !> none of this kind or the arguments are not right.
   logical function entered(handle, mark, box, status, right, wrong)
      type(c_ptr), intent(in) :: handle
      integer, intent(in) :: mark                          !! OF_JOINTS or OF_MODEL
      type(box_t), pointer, intent(out) :: box
      integer(c_int), intent(out) :: status
      logical, intent(in), optional :: right               !! are the arguments right?
      character(len=*), intent(in), optional :: wrong      !! the message when they are not

      status = ERR_INPUT
      box => null()
      entered = c_associated(handle)
      if (.not. entered) return
      call c_f_pointer(handle, box)
      entered = box%mark == mark
      if (.not. (entered .and. present(right))) return
      entered = right
      if (.not. right) status = refuse(wrong, box%message)
   end function entered

   !> Begin a call that makes a handle: null, until it is made
   logical function has_room(place, right, wrong, message, size, status)
      type(c_ptr), intent(in) :: place                     !! where the handle goes
      logical, intent(in) :: right                         !! are the other arguments right?
      character(len=*), intent(in) :: wrong                !! the message when they are not
      type(c_ptr), intent(in) :: message                   !! buffer of the caller
      integer(c_size_t), intent(in) :: size
      integer(c_int), intent(out) :: status

      type(c_ptr), pointer :: handle

      if (c_associated(place)) then
         call c_f_pointer(place, handle)
         handle = c_null_ptr
      end if
      has_room = right .and. c_associated(place)
      if (.not. has_room) status = put_text(wrong, message, size)
      status = ERR_INPUT
   end function has_room

   !> Give a new handle to the caller, or say why there is none
   subroutine hand_out(box, mark, status, text, message, size, place)
      type(box_t), pointer, intent(inout) :: box           !! freed when there is none
      integer, intent(in) :: mark                          !! OF_JOINTS or OF_MODEL
      integer(c_int), intent(in) :: status
      character(len=*), intent(in) :: text
      type(c_ptr), intent(in) :: message                   !! buffer of the caller
      integer(c_size_t), intent(in) :: size
      type(c_ptr), intent(in) :: place                     !! where the handle goes

      type(c_ptr), pointer :: out
      integer(c_int) :: ignored

      ignored = put_text(text, message, size)
      if (status == OK) then
         box%mark = mark
         box%message = ''
         call c_f_pointer(place, out)
         out = c_loc(box)
      else
         deallocate (box)
      end if
   end subroutine hand_out

   !> Free a handle; one that runs stays, as its run goes on
   subroutine release(handle, mark)
      type(c_ptr), intent(in) :: handle
      integer, intent(in) :: mark                          !! OF_JOINTS or OF_MODEL

      type(box_t), pointer :: box
      integer(c_int) :: status

      if (.not. entered(handle, mark, box, status)) return
      if (box%running) return
      box%mark = 0
      deallocate (box)
   end subroutine release

   !> Status of a call, and its message kept
   integer(c_int) function outcome(error, message) result(status)
      type(error_t), allocatable, intent(in) :: error
      character(len=:), allocatable, intent(inout) :: message

      status = OK
      message = ''
      if (.not. allocated(error)) return
      status = int(error%code, c_int)
      message = error%message
   end function outcome

   !> Status of a call with a wrong argument, and its message kept
   integer(c_int) function refuse(text, message) result(status)
      character(len=*), intent(in) :: text
      character(len=:), allocatable, intent(inout) :: message

      status = ERR_INPUT
      message = text
   end function refuse

   !> A text into the buffer of a caller, cut to its size, ended by a zero
   integer(c_int) function put_text(text, buffer, size) result(status)
      character(len=*), intent(in) :: text
      type(c_ptr), intent(in) :: buffer
      integer(c_size_t), intent(in) :: size

      character(kind=c_char), pointer :: letters(:)
      integer :: i, n

      status = ERR_INPUT
      if (.not. c_associated(buffer)) return
      status = OK
      if (size < 1) return
      n = int(min(size - 1, int(len(text), c_size_t)))
      call c_f_pointer(buffer, letters, [n + 1])
      do i = 1, n
         letters(i) = text(i:i)
      end do
      letters(n + 1) = c_null_char
   end function put_text

   !> A number to where a caller wants it
   integer(c_int) function put_count(count, n) result(status)
      integer, intent(in) :: count
      type(c_ptr), intent(in) :: n

      integer(c_int), pointer :: number

      status = ERR_INPUT
      if (.not. c_associated(n)) return
      call c_f_pointer(n, number)
      number = int(count, c_int)
      status = OK
   end function put_count

   !> Findings of one severity and worse, or of less, a line each
   subroutine list_findings(findings, errors, text)
      type(finding_list_t), intent(in) :: findings
      logical, intent(in) :: errors              !! errors, else warnings
      character(len=:), allocatable, intent(out) :: text

      integer :: i

      text = ''
      do i = 1, findings%n
         associate (f => findings%item(i))
            if ((f%severity == SEV_ERROR) .neqv. errors) cycle
            if (f%severity == SEV_NOTE) cycle
            if (len(text) > 0) text = text//new_line('a')
            if (f%line > 0) text = text//f%file//':'//str(f%line)//':'//str(f%first)//': '
            if (len_trim(f%id) > 0) text = text//'['//trim(f%id)//'] '
            text = text//f%message
         end associate
      end do
   end subroutine list_findings

   !> As C has it
   pure function c_joint_result(r) result(c)
      type(joint_result_t), intent(in) :: r
      type(c_joint_result_t) :: c

      c%id = int(r%id, c_int)
      c%type = int(r%type, c_int)
      c%force = r%force
      c%displacement = r%displacement
      c%frame = r%frame
      c%energy = r%energy
      c%dissipated = r%dissipated
      c%orthogonality = r%orthogonality
   end function c_joint_result

end module kjoint_c_base
