!> A part of a model as a model of its own, which knows its joints, loads and conditions alone, and
!> where its leads and joints are in the whole.
module kj_cut_model
   use kj_joint_batch, only: joint_batch_t, limits_t
   use kj_lead_map, only: build_lead_map
   use kj_model, only: model_t, load_t
   use kj_islands, only: element_leads
   implicit none
   private

   public :: cut_t, cut_model

   !> The part
   type :: cut_t
      integer, allocatable :: lead(:)          !! (n_lead) index of each in the whole
      integer, allocatable :: node(:)          !! (n_node)
      integer, allocatable :: skew(:)          !! (n_skew)
      integer, allocatable :: batch(:)         !! (batches)
      integer, allocatable :: element(:)       !! (n_element) both in the order of the batches
   end type cut_t

contains

   !> Cut out leads and elements. Leads may stand in several parts, elements in one.
   pure subroutine cut_model(model, leads, loaded, elements, cut, section)
      type(model_t), intent(in) :: model
      logical, intent(in) :: leads(:)          !! (n_lead) are in the part
      logical, intent(in) :: loaded(:)         !! (n_lead) their loads are in the part
      logical, intent(in) :: elements(:)       !! (n_element) in the order of the batches
      type(cut_t), intent(out) :: cut
      type(model_t), intent(out) :: section   !! the part as a model

      integer :: new(0:model%n_node), new_skew(0:model%skews%n)

      section%control = model%control
      section%units = model%units
      section%curves = model%curves
      section%title = model%title
      call cut_loads(model, leads, loaded, section)
      call cut_skews(model, cut, new_skew, section)
      call cut_leads(model, leads, elements, cut, new, section)
      call cut_batches(model, elements, new, cut, section)
      call cut_joints(model, elements, new, cut, section)
      call renumber(new, new_skew, section)
      allocate (section%th_joint(0), section%th_spring(0), section%th_body(0), &
         section%th_node(0), section%th_node_skew(0), section%th_node_name(0))
   end subroutine cut_model

   !> Loads, conditions and motions, still with the numbers of the whole
   pure subroutine cut_loads(model, leads, loaded, section)
      type(model_t), intent(in) :: model
      logical, intent(in) :: leads(:), loaded(:)
      type(model_t), intent(inout) :: section   !! the part as a model

      section%bcs = pack(model%bcs, leads(model%bcs%lead))
      section%motion = pack(model%motion, leads(model%motion%lead))
      call cut_cards(model%gravity, section%gravity)
      call cut_cards(model%cload, section%cload)

   contains

      !> Cards that act on loaded leads, with their nodes there
      pure subroutine cut_cards(card, part)
         type(load_t), intent(in) :: card(:)
         type(load_t), allocatable, intent(out) :: part(:)

         logical :: acts(size(card))
         integer :: i, k

         do i = 1, size(card)
            acts(i) = any(loaded(model%lead(card(i)%node)))
         end do
         allocate (part(count(acts)))
         k = 0
         do i = 1, size(card)
            if (.not. acts(i)) cycle
            k = k + 1
            part(k) = card(i)
            part(k)%node = pack(card(i)%node, loaded(model%lead(card(i)%node)))
         end do
      end subroutine cut_cards
   end subroutine cut_loads

   !> The skews that the loads of the part read; the axes of its joints stand in the batches
   pure subroutine cut_skews(model, cut, new, section)
      type(model_t), intent(in) :: model
      type(cut_t), intent(inout) :: cut
      type(model_t), intent(inout) :: section   !! the part as a model
      integer, intent(out) :: new(0:)

      logical :: used(0:model%skews%n), needed(model%skews%n)
      integer :: i

      used = .false.
      used(section%bcs%skew) = .true.
      used(section%motion%skew) = .true.
      used(section%gravity%skew) = .true.
      used(section%cload%skew) = .true.
      cut%skew = pack([(i, i=1, model%skews%n)], used(1:))
      new = 0
      new(cut%skew) = [(i, i=1, size(cut%skew))]
      needed = .false.
      needed(model%skews%needed) = .true.
      associate (old => model%skews, part => section%skews)
         part%n = size(cut%skew)
         part%id = old%id(cut%skew)
         part%node = old%node(:, cut%skew)
         part%dir = old%dir(cut%skew)
         allocate (part%axes(0:part%n, 9))
         part%axes = old%axes([0, cut%skew], :)
         part%needed = pack([(i, i=1, part%n)], needed(cut%skew))
      end associate
   end subroutine cut_skews

   !> Leads, and the secondary nodes that joints, skews or loads read
   pure subroutine cut_leads(model, leads, elements, cut, new, section)
      type(model_t), intent(in) :: model
      logical, intent(in) :: leads(:), elements(:)
      type(cut_t), intent(inout) :: cut
      type(model_t), intent(inout) :: section   !! the part as a model
      integer, intent(out) :: new(0:)          !! (0:n_node) number in the part, 0 = not there

      logical :: used(0:model%n_node)
      integer :: i

      used = .false.
      do i = 1, model%n_element
         if (elements(at(i))) used(model%joint(i)%node) = .true.
      end do
      do i = 1, section%skews%n
         used(section%skews%node(:, i)) = .true.
      end do
      do i = 1, size(section%cload)
         used(section%cload(i)%node) = .true.
      end do
      used(1:model%n_lead) = leads
      cut%node = pack([(i, i=1, model%n_node)], used(1:))
      cut%lead = pack([(i, i=1, model%n_lead)], leads)
      new = 0
      new(cut%node) = [(i, i=1, size(cut%node))]
      associate (part => section, n => cut%node, l => cut%lead)
         part%n_node = size(n)
         part%n_lead = size(l)
         part%n_body = count(l <= model%n_body)
         part%node_id = model%node_id(n)
         part%lead = new(model%lead(n))
         part%x0 = model%x0(n, :)
         part%v0 = model%v0(n, :)
         part%w0 = model%w0(l, :)
         part%mass = model%mass(l)
         part%inertia = model%inertia(l)
         part%node_mass = model%node_mass(n)
         part%node_inertia = model%node_inertia(n)
      end associate
      associate (part => section, l => cut%lead(:section%n_body))
         part%body_id = model%body_id(l)
         part%principal = model%principal(l, :)
         part%axes = model%axes(l, :)
         part%ispher = model%ispher(l)
         part%n_secondary = model%n_secondary(l)
      end associate

   contains

      !> Index of joint i in the order of the batches
      pure integer function at(i)
         integer, intent(in) :: i

         at = model%batch(model%joint(i)%batch)%first + model%joint(i)%place
      end function at
   end subroutine cut_leads

   !> The joints of the part, batch by batch
   pure subroutine cut_batches(model, elements, new, cut, section)
      type(model_t), intent(in) :: model
      logical, intent(in) :: elements(:)
      integer, intent(in) :: new(0:)
      type(cut_t), intent(inout) :: cut
      type(model_t), intent(inout) :: section   !! the part as a model

      integer :: b, i, first

      associate (batch => model%batch)
         cut%batch = pack([(b, b=1, size(batch))], [(any(elements(batch(b)%first + 1: &
            batch(b)%first + batch(b)%n)), b=1, size(batch))])
      end associate
      allocate (section%batch(size(cut%batch)))
      cut%element = pack([(i, i=1, model%n_element)], elements)
      first = 0
      do b = 1, size(cut%batch)
         associate (old => model%batch(cut%batch(b)), part => section%batch(b))
            call cut_batch(old, pack([(i, i=1, old%n)], &
               elements(old%first + 1:old%first + old%n)), new, part)
            part%first = first
            first = first + part%n
         end associate
      end do
      section%n_element = first
      call build_lead_map(section%n_lead, element_leads(section), section%map)
   end subroutine cut_batches

   !> Some joints of a batch
   pure subroutine cut_batch(old, rows, new, part)
      type(joint_batch_t), intent(in) :: old
      integer, intent(in) :: rows(:), new(0:)
      type(joint_batch_t), intent(inout) :: part

      integer :: e

      part%n = size(rows)
      part%row = old%row
      part%frame = old%frame
      part%law = old%law
      part%kind = old%kind
      part%limited = old%limited
      allocate (part%node(part%n, 2), part%lead(part%n, 2))
      do e = 1, 2
         part%node(:, e) = new(old%node(rows, e))
         part%lead(:, e) = new(old%lead(rows, e))
      end do
      allocate (part%skew(part%n, 2), source=0)
      part%xl0 = old%xl0(rows, :)
      part%frame0 = old%frame0(rows, :)
      part%k = old%k(rows, :)
      part%c = old%c(rows, :)
      part%cr = old%cr(rows)
      part%reduced = old%reduced(rows, :)
      part%scale = old%scale(rows)
      part%k_curve = old%k_curve(rows, :)
      part%c_curve = old%c_curve(rows, :)
      part%k_top = old%k_top(rows, :)
      part%c_top = old%c_top(rows, :)
      part%angle0 = old%angle0(rows, :)
      if (allocated(old%spring)) part%spring = old%spring(rows)
      if (old%limited) call cut_limits(old%limit, rows, part%limit)
   end subroutine cut_batch

   pure subroutine cut_limits(old, rows, part)
      type(limits_t), intent(in) :: old
      integer, intent(in) :: rows(:)
      type(limits_t), intent(inout) :: part

      part%lo = old%lo(rows, :)
      part%hi = old%hi(rows, :)
      part%combined = old%combined(rows, :)
      part%k = old%k(rows, :)
      part%slip = old%slip(rows, :)
      part%slip_curve = old%slip_curve(rows, :)
      part%cr = old%cr(rows)
      part%cr_stop = old%cr_stop(rows)
      part%k_block = old%k_block(rows, :)
      part%automatic = old%automatic(rows)
      part%t_lock = old%t_lock(rows)
      part%t_free = old%t_free(rows)
   end subroutine cut_limits

   !> What messages say of the joints, in the order of the deck
   pure subroutine cut_joints(model, elements, new, cut, section)
      type(model_t), intent(in) :: model
      logical, intent(in) :: elements(:)
      integer, intent(in) :: new(0:)
      type(cut_t), intent(in) :: cut
      type(model_t), intent(inout) :: section   !! the part as a model

      integer :: batch_of(size(model%batch)), place_of(model%n_element), b, j, k, at

      batch_of = 0
      batch_of(cut%batch) = [(b, b=1, size(cut%batch))]
      place_of = 0
      k = 0
      do b = 1, size(cut%batch)
         do j = 1, section%batch(b)%n
            k = k + 1
            place_of(cut%element(k)) = j
         end do
      end do
      allocate (section%joint(section%n_element))
      k = 0
      do j = 1, model%n_element
         at = model%batch(model%joint(j)%batch)%first + model%joint(j)%place
         if (.not. elements(at)) cycle
         k = k + 1
         if (j <= model%n_joint) section%n_joint = k
         associate (joint => section%joint(k))
            joint = model%joint(j)
            joint%batch = batch_of(joint%batch)
            joint%place = place_of(at)
            joint%node = new(joint%node)
         end associate
      end do
      section%n_spring = section%n_element - section%n_joint
   end subroutine cut_joints

   !> Loads, conditions and skews from the numbers of the whole to those of the part
   pure subroutine renumber(new, new_skew, part)
      integer, intent(in) :: new(0:), new_skew(0:)
      type(model_t), intent(inout) :: part

      integer :: i

      part%bcs%lead = new(part%bcs%lead)
      part%bcs%skew = new_skew(part%bcs%skew)
      part%motion%lead = new(part%motion%lead)
      part%motion%skew = new_skew(part%motion%skew)
      part%gravity%skew = new_skew(part%gravity%skew)
      part%cload%skew = new_skew(part%cload%skew)
      do i = 1, size(part%gravity)
         part%gravity(i)%node = new(part%gravity(i)%node)
      end do
      do i = 1, size(part%cload)
         part%cload(i)%node = new(part%cload(i)%node)
      end do
      do i = 1, part%skews%n
         part%skews%node(:, i) = new(part%skews%node(:, i))
      end do
   end subroutine renumber

end module kj_cut_model
