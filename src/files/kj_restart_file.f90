!> The file of a checkpoint, RUN.restart.h5: the state of a run as bytes, and as attributes what is
!> needed to go on: the decks, the options, the history. It is written beside, and takes its name
!> when it is whole and on the disk.
module kj_restart_file
   use, intrinsic :: iso_fortran_env, only: int8
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, ERR_FILE
   use kj_system, only: sync_file
   use kj_text, only: text_t
   use kj_version, only: KJOINT_VERSION
   use kj_channels, only: AS_F64, AS_I64
   use kj_output, only: begin_output, end_output
   use kj_h5, only: hid_t, start_hdf5, create_file, open_file, close_file, put_text, put_number
   use kj_h5_write, only: write_bytes
   use kj_h5_read, only: read_bytes, get_text, get_numbers
   implicit none
   private

   public :: restart_t, write_restart, read_restart

   !> What a checkpoint holds
   type :: restart_t
      character(len=:), allocatable :: starter, engine   !! paths of the decks; engine may be ''
      character(len=:), allocatable :: history           !! path of the history
      character(len=:), allocatable :: options           !! of the run, for read_run_options
      real(wp) :: time = 0.0_wp
      integer :: cycle = 0
      integer(int8), allocatable :: state(:)             !! as restore_simulation takes it
   end type restart_t

contains

   !> Write a checkpoint; an older one of this name stays until the new one is whole.
   !> Errors: ERR_FILE
   subroutine write_restart(path, restart, error)
      character(len=*), intent(in) :: path
      type(restart_t), intent(in) :: restart
      type(error_t), allocatable, intent(out) :: error

      type(error_t), allocatable :: closing
      character(len=:), allocatable :: place, part
      integer(hid_t) :: file
      logical :: done

      call begin_output(path, [text_t ::], place, part, error)
      if (allocated(error)) return
      call start_hdf5(error)
      call create_file(part, file, error, image=.false., live=.false.)
      call put_text(file, 'title', 'state of a kjoint run, to go on from', error)
      call put_text(file, 'source', 'kjoint '//KJOINT_VERSION, error)
      call put_text(file, 'starter', restart%starter, error)
      call put_text(file, 'engine', restart%engine, error)
      call put_text(file, 'history', restart%history, error)
      call put_text(file, 'options', restart%options, error)
      call put_number(file, 'time', AS_F64, restart%time, error)
      call put_number(file, 'cycle', AS_I64, real(restart%cycle, wp), error)
      call write_bytes(file, 'state', restart%state, error)
      call close_file(file, closing)
      if (allocated(closing) .and. .not. allocated(error)) call move_alloc(closing, error)
      call sync_file(part, done)
      if (.not. (done .or. allocated(error))) call fail(error, ERR_FILE, 'it is not on the disk')
      call end_output(part, place, error)
   end subroutine write_restart

   !> Read a checkpoint. Errors: ERR_FILE
   subroutine read_restart(path, restart, error)
      character(len=*), intent(in) :: path
      type(restart_t), intent(out) :: restart
      type(error_t), allocatable, intent(out) :: error

      integer(hid_t) :: file
      real(wp) :: number(1)
      logical :: found, exists

      inquire (file=path, exist=exists)
      if (.not. exists) then
         call fail(error, ERR_FILE, 'there is no checkpoint '//path)
         return
      end if
      call start_hdf5(error)
      call open_file(path, file, error)
      call get_text(file, 'starter', restart%starter, error)
      call get_text(file, 'engine', restart%engine, error)
      call get_text(file, 'history', restart%history, error)
      call get_text(file, 'options', restart%options, error)
      call get_numbers(file, 'time', number, found, error)
      if (found) restart%time = number(1)
      call get_numbers(file, 'cycle', number, found, error)
      if (found) restart%cycle = nint(number(1))
      call read_bytes(file, 'state', restart%state, error)
      call close_file(file, error)
      if (.not. allocated(error)) return
      deallocate (error)
      call fail(error, ERR_FILE, path//' is no checkpoint, or a damaged one')
   end subroutine read_restart

end module kj_restart_file
