!> What the C functions share: handles, texts, structures. include/kjoint.h says what they mean.
module kjoint_c_base
   use, intrinsic :: iso_c_binding, only: c_ptr, c_char, c_int, c_size_t, c_double, c_long_long, &
      c_f_pointer, c_associated, c_null_char
   use kj_error, only: error_t, finding_list_t, str, ERR_INPUT, SEV_NOTE, SEV_ERROR
   use kj_host, only: joint_set_t, joint_result_t
   use kj_sink_memory, only: sink_memory_t
   use kjoint, only: simulation_t, run_status_t
   implicit none
   private

   public :: joints_box_t, model_box_t, find_joints, find_model, outcome, refuse, get_text, &
      put_text, list_findings, fixed_text
   public :: c_joint_result_t, c_joint_result

   integer, parameter, public :: OK = 0
   integer, parameter, public :: MARK_JOINTS = 1263157841, MARK_MODEL = 1263157842   !! of handles

   !> What a kj_joints handle points to
   type :: joints_box_t
      integer :: mark = 0
      type(joint_set_t) :: set
      character(len=:), allocatable :: message
   end type joints_box_t

   !> What a kj_model handle points to
   type :: model_box_t
      integer :: mark = 0
      type(simulation_t) :: sim
      type(sink_memory_t) :: samples
      type(run_status_t) :: status
      logical :: stepping = .false.              !! the status is that of the scene
      type(finding_list_t) :: findings
      character(len=:), allocatable :: message
   end type model_box_t

   !> kj_joint_result
   type, bind(c) :: c_joint_result_t
      integer(c_int) :: id, type
      real(c_double) :: force(6), displacement(6), frame(3, 3), energy, dissipated, orthogonality
   end type c_joint_result_t

contains

   !> The set behind a handle; not associated when it is none
   subroutine find_joints(handle, box)
      type(c_ptr), intent(in) :: handle
      type(joints_box_t), pointer, intent(out) :: box

      box => null()
      if (.not. c_associated(handle)) return
      call c_f_pointer(handle, box)
      if (box%mark /= MARK_JOINTS) box => null()
   end subroutine find_joints

   !> The model behind a handle; not associated when it is none
   subroutine find_model(handle, box)
      type(c_ptr), intent(in) :: handle
      type(model_box_t), pointer, intent(out) :: box

      box => null()
      if (.not. c_associated(handle)) return
      call c_f_pointer(handle, box)
      if (box%mark /= MARK_MODEL) box => null()
   end subroutine find_model

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

   !> A C text; '' for a null pointer. (No function: see str of kj_error.)
   subroutine get_text(pointer, text)
      type(c_ptr), intent(in) :: pointer
      character(len=:), allocatable, intent(out) :: text

      integer, parameter :: MOST = 100000
      character(kind=c_char), pointer :: letters(:)
      integer :: i, n

      n = 0
      if (c_associated(pointer)) then
         call c_f_pointer(pointer, letters, [MOST])
         do while (n < MOST)
            if (letters(n + 1) == c_null_char) exit
            n = n + 1
         end do
      end if
      allocate (character(len=n) :: text)
      do i = 1, n
         text(i:i) = letters(i)
      end do
   end subroutine get_text

   !> Text of a fixed C array
   pure function fixed_text(letters) result(text)
      character(kind=c_char), intent(in) :: letters(:)
      character(len=size(letters)) :: text

      integer :: i

      text = ''
      do i = 1, size(letters)
         if (letters(i) == c_null_char) exit
         text(i:i) = letters(i)
      end do
   end function fixed_text

   !> A text into the buffer of a caller, cut to its size, ended by a zero
   subroutine put_text(text, buffer, size)
      character(len=*), intent(in) :: text
      type(c_ptr), intent(in) :: buffer
      integer(c_size_t), intent(in) :: size

      character(kind=c_char), pointer :: letters(:)
      integer :: i, n

      if (.not. c_associated(buffer) .or. size < 1) return
      n = int(min(size - 1, int(len(text), c_size_t)))
      call c_f_pointer(buffer, letters, [n + 1])
      do i = 1, n
         letters(i) = text(i:i)
      end do
      letters(n + 1) = c_null_char
   end subroutine put_text

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
